"""Recognising from the readings that the arm rests, and how well its velocity is then known to be zero: compiled.

An arm that moves at constant speed and one that rests read nearly alike. So three things must agree over a window:
the readings stay what they are, they are what an arm at rest in the estimated pose would read, and the estimated
velocities are nothing to speak of; each within what noise and the filter's own covariance allow.

What could still hide is an acceleration as small as the window's noise. An arm that comes to rest loses its speed
within a time of about a second, so the speed that could hide is that acceleration times a second.

This is the detector of the filters and the smoother (and `unsteadiness` that of a recording's first readings);
`tracking.dead_reckoning.rest` is for the integrator, which has no covariance to ask.
"""

import math
from typing import NamedTuple

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.model.expected_readings import Room, observe
from tracking.model.observation import Observation

#: How long the readings must stay what they are, and the cells in which they are compared.
WINDOW_S, CELL_S = 0.25, 0.01
#: Standard deviations that a window may be off, by chance once in 16 000, and a cell of it, once in 26 million.
_WINDOW_SIGMAS, _CELL_SIGMAS = 4.0, 5.5
#: An arm that comes to rest loses its speed within this time [s], a convention.
_SETTLING_S = 1.0
#: Standard deviations of an acceleration within which it could hide, all but 0.3 % of the time; the standard
#: deviation of an undetectable speed is that of one that lasts as long as the arm takes to come to rest.
_HIDDEN_SIGMAS = 3.0
#: Correlation time of a hidden speed [s]: many readings at rest say little more than one. A convention.
_MEMORY_S = 0.5
#: Factor by which the window must be further from rest to end one than to begin one, against fluttering; as in
#: `tracking.dead_reckoning.rest` a convention.
TO_LEAVE = 3.0
#: No joint accelerates more [rad/s^2 or m/s^2]: a prior so wide that it only keeps a matrix regular.
_MOST_ACCELERATION = 100.0


class Window(NamedTuple):
    """The last quarter of a second in cells.

    Attributes
    ----------
    cells : (n_cell, n_channel)
        Means of readings, a ring.
    room_reading, room_slope : (n_channel,), (n_channel, n_state)
    noise : (n_channel,)
        Variance of a cell's mean.
    rounding : (n_channel,)
        Variance of what the converter hides from every reading alike while nothing moves.
    """

    cells: Floats
    room_reading: Floats
    room_slope: Floats
    noise: Floats
    rounding: Floats


def window_frames(dt_s: float) -> tuple[int, int]:
    """Return how many frames make a cell, and how many cells a window, (2,)."""
    cell = max(1, round(CELL_S / dt_s))
    return cell, max(4, round(WINDOW_S / (cell * dt_s)))


def window_of(n_cell: int, size: int, cell_noise: Floats, rounding: Floats) -> Window:
    """Return an empty window.

    Parameters
    ----------
    n_cell : int
    size : int
        Entries of the state.
    cell_noise, rounding : (n_channel,)
        Variances, see `Window`.
    """
    n_channel = len(cell_noise)
    cells = np.zeros((n_cell, n_channel))
    return Window(cells, np.zeros(n_channel), np.zeros((n_channel, size)), cell_noise, rounding)


@compiled
def unsteadiness(window: Window, oldest: int) -> float:
    """Return how far the readings in the window change, as a share of what noise may do; ``oldest`` is a row."""
    cells = window.cells
    n_cell, half = cells.shape[0], cells.shape[0] // 2
    worst = 0.0
    for channel in range(cells.shape[1]):
        early, late, mean = 0.0, 0.0, cells[:, channel].mean()
        for i in range(half):
            early += cells[(oldest + i) % n_cell, channel] / half
            late += cells[(oldest + n_cell - half + i) % n_cell, channel] / half
        sigma = math.sqrt(2.0 * window.noise[channel] / half + 2.0 * window.rounding[channel])
        worst = max(worst, abs(late - early) / (_WINDOW_SIGMAS * sigma))
        sigma = math.sqrt(window.noise[channel] + window.rounding[channel])
        worst = max(worst, np.abs(cells[:, channel] - mean).max() / (_CELL_SIGMAS * sigma))
    return worst


@compiled
def unrest(
    of: Observation, room: Room, window: Window, oldest: int, x: Floats, P: Floats, hidden: Floats
) -> float:
    """Return how far the window is from rest, as a share of what a rest may be off: below 1 the arm rests.

    The variance of the speed that could hide is left in ``hidden`` (n_joint,).
    """
    n, n_cell = hidden.size, window.cells.shape[0]
    worst = unsteadiness(window, oldest)
    observe(of, room, at_rest(x, n), window.room_reading, window.room_slope)
    seen = np.eye(n) / _MOST_ACCELERATION**2
    for channel in range(window.noise.size):
        o, slope = 3 * n + channel, window.room_slope[channel]
        within = window.noise[channel] / n_cell + window.rounding[channel]
        level = window.room_reading[channel]
        if of.settled_column[channel // 3] >= 0:
            level -= x[o]  # of an AC-coupled channel the cells hold what is left without its offset
        variance = within + level_variance(of, channel, n, slope, P)
        for j in range(of.link[channel // 3] + 1):
            for i in range(of.link[channel // 3] + 1):
                seen[i, j] += slope[3 * i + 2] * slope[3 * j + 2] / within
        off = abs(window.cells[:, channel].mean() - level)
        worst = max(worst, off / (_WINDOW_SIGMAS * math.sqrt(variance)))
    acceleration = np.linalg.inv(seen)
    for j in range(n):
        hidden[j] = (_HIDDEN_SIGMAS * _SETTLING_S) ** 2 * acceleration[j, j]
        speed = math.sqrt(hidden[j]) + math.sqrt(P[3 * j + 1, 3 * j + 1])
        worst = max(worst, abs(x[3 * j + 1]) / (_WINDOW_SIGMAS * speed))
    return worst


@compiled
def at_rest(x: Floats, n: int) -> Floats:
    """Return a state without the speeds and accelerations of its n joints."""
    still = x.copy()
    for j in range(n):
        still[3 * j + 1] = still[3 * j + 2] = 0.0
    return still


@compiled
def level_variance(of: Observation, channel: int, n: int, slope: Floats, P: Floats) -> float:
    """Return the variance of what a channel should read at rest: from all but speeds and accelerations."""
    variance = 0.0
    for c in of.columns[channel, : of.n_column[channel]]:
        for b in of.columns[channel, : of.n_column[channel]]:
            if (c >= 3 * n or c % 3 == 0) and (b >= 3 * n or b % 3 == 0):
                variance += slope[b] * slope[c] * P[b, c]
    return variance


@compiled
def rest_variance(hidden: Floats, dt: float) -> Floats:
    """Return the variance of velocities' being zero, to be taken in at every instant of a rest."""
    return hidden * 2.0 * _MEMORY_S / dt
