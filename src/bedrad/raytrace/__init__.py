"""Rays from the wall to exact spheres: view factors, and how sure they are."""
