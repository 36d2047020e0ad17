"""Up to which frequency the columns of a run are looked at: as far as most of its motion goes, and no lower.

Above some 30 Hz hardly any motion is left, and the noise of an angle that was differentiated twice is large enough
to bend the regressors. A loop that is late by a few milliseconds may swing nearly as fast, and do nothing else.
"""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.data.resample import Uniform
from fitter.diagnosis.motion import white_noise

#: Columns are cut off at this frequency …
CORNER_HZ = 30.0
#: … or at so many times that below which this share of a joint's speed squared lies, for what is as quick has
#: overtones; if the sampling allows it, for which this share of its rate is left.
_TIMES, _MOST, _SHARE_OF_RATE = 3.0, 0.9, 0.2
#: A joint whose motion is less than so many times its noise does not count.
_MOVES = 10.0


def corner_hz(grids: Sequence[Uniform]) -> float:
    """Return the corner that the columns of a run are cut off at [Hz].

    Parameters
    ----------
    grids : sequence of Uniform
        Their angles ``q``.
    """
    highest = _SHARE_OF_RATE / max(grid.dt_s for grid in grids)
    quick = _quick_hz(grids, highest)
    return float(min(max(CORNER_HZ, _TIMES * quick), highest))


def _quick_hz(grids: Sequence[Uniform], highest: float) -> float:
    """Return the frequency below which most of the quickest joint's speed squared lies, noise taken off."""
    angles = [grid.measured.columns["q"] for grid in grids]
    noise = white_noise(angles)
    f = np.linspace(0.0, highest, 400)
    power = np.zeros((len(f), len(noise)))
    own = np.zeros_like(power)
    for grid, q in zip(grids, angles, strict=True):
        steps = np.diff(q, axis=0)
        at, one = np.fft.rfftfreq(len(steps), grid.dt_s), np.abs(np.fft.rfft(steps, axis=0)) ** 2
        total: Floats = np.cumsum(one, axis=0)
        white = np.cumsum(4.0 * np.sin(np.pi * at * grid.dt_s) ** 2) * len(steps)
        power += np.stack([np.interp(f, at, column) for column in total.T], axis=1)
        own += np.interp(f, at, white)[:, None] * noise**2
    moves = power[-1] > _MOVES * own[-1]
    quick = [f[np.argmax(power[:, j] - own[:, j] > _MOST * (power - own)[-1, j])] for j in np.flatnonzero(moves)]
    return float(max(quick, default=0.0))
