"""Engines with known properties, to hold the measuring of engines against."""

from __future__ import annotations

import numpy as np


class Clock:
    """A clock that only goes on when it is told to, in place of the module `time`."""

    def __init__(self):
        self.now = 0.0

    def process_time(self):
        return self.now

    perf_counter = process_time


class BiasedTracer:
    """Sends a known share of the rays of one layer elsewhere.

    Rays are told apart by digits of their points that no geometry sees, so that the share is met whatever the bed.
    """

    def __init__(self, exact, share, source=0, target=1):
        self.exact, self.share, self.source, self.target = exact, share, source, target

    def fates(self, points):
        fates = self.exact.fates(points).copy()
        fates[(fates == self.source) & (dice(points) < self.share)] = self.target
        return fates


class Coins:
    """Every ray ends by the throw of dice of its point's digits: shares that are known exactly, plain Monte Carlo."""

    def __init__(self, shares):
        self.bounds = np.cumsum(shares)[:-1]

    def fates(self, points):
        return np.searchsorted(self.bounds, dice(points), side="right")


def dice(points):
    """Numbers from 0 to 1, independent of each other for points of any order."""
    return np.mod(points @ np.array([1e5, 3e5, 7e5, 9e5]) * np.sqrt(2.0), 1.0)
