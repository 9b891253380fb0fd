"""Packings of spheres: making, reading and writing them, cutting them into layers, measuring them."""
