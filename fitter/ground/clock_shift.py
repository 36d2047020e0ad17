"""How much later the forces' clock is than the markers': the most likely shift by the vertical force."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from arm.model import Floats
from limbcal.note import Note

#: Clocks are compared by what is slower: of a motion from markers, the rest is noise (Winter 2009) [Hz].
FASTEST_HZ = 6.0
#: Largest shift that is sought [s], and the steps of the search.
_LARGEST_S, _STEPS = 0.25, 101
#: A shift is believed if it makes the measured force likelier by this factor, as a logarithm: one in a thousand
#: of a chi-square with one degree of freedom.
_BELIEVED = 0.5 * 10.83


@dataclass(frozen=True)
class ClockShift:
    """A shift of the forces' clock.

    Attributes
    ----------
    shift_s : float
        The force of the motion's time t stands at ``t + shift_s`` on the forces' clock.
    std_s : float
    """

    shift_s: float
    std_s: float

    @property
    def notes(self) -> tuple[Note, ...]:
        """What is said of it: nothing where the clocks agree."""
        if self.shift_s == 0.0:
            return ()
        late = "later" if self.shift_s > 0.0 else "earlier"
        text = (
            f"the forces' clock is {1e3 * abs(self.shift_s):.1f} ± {1e3 * 1.96 * self.std_s:.1f} ms {late} "
            f"than the motion's by the vertical force: put right"
        )
        return (Note("clock", text),)


def clock_shift(
    predicted: Floats, measured: Floats, dt_s: float, band_hz: float, usable: NDArray[np.bool_] | None = None
) -> ClockShift:
    """Return the most likely shift.

    Parameters
    ----------
    predicted, measured : (n_sample,) [N]
        Along the vertical, both behind the same filter. Their means and sizes may differ: masses are not known
        yet.
    dt_s, band_hz : float
        Two independent samples a period of the filter's corner are counted.
    usable : (n_sample,) bool, optional
        Where the two may be compared; everywhere if None.
    """
    t = np.arange(len(measured)) * dt_s
    edge = int(np.ceil(_LARGEST_S / dt_s))
    around = np.ones(2 * edge + 1, dtype=np.bool_)
    inner = binary_erosion(np.ones(len(t), dtype=np.bool_) if usable is None else usable, around)
    n_effective = 2.0 * min(band_hz, 0.5 / dt_s) * int(inner.sum()) * dt_s
    if inner.sum() <= 2 * edge:
        return ClockShift(0.0, np.inf)
    shifts = np.linspace(-_LARGEST_S, _LARGEST_S, _STEPS)
    model = predicted[inner] - predicted[inner].mean()
    cost = np.empty(_STEPS)
    for k, shift in enumerate(shifts):
        one = np.interp(t[inner] + shift, t, measured)
        one = one - one.mean()
        size = (model @ one) / max(float(model @ model), 1e-300)
        cost[k] = float(np.mean((one - size * model) ** 2)) / max(float(np.mean(one**2)), 1e-300)
    likelihood = -0.5 * n_effective * np.log(np.maximum(cost, 1e-12))
    best = int(np.argmax(likelihood))
    if best in (0, _STEPS - 1) or likelihood[best] - likelihood[_STEPS // 2] < _BELIEVED:
        return ClockShift(0.0, np.inf if best in (0, _STEPS - 1) else _std(likelihood, _STEPS // 2, shifts))
    left, here, right = likelihood[best - 1 : best + 2]
    step = float(shifts[1] - shifts[0])
    return ClockShift(
        float(shifts[best]) + 0.5 * step * float((left - right) / (left - 2.0 * here + right)),
        _std(likelihood, best, shifts),
    )


def _std(likelihood: Floats, at: int, shifts: Floats) -> float:
    left, here, right = likelihood[at - 1 : at + 2]
    curvature = float(2.0 * here - left - right) / float(shifts[1] - shifts[0]) ** 2
    return float(curvature**-0.5) if curvature > 0.0 else float(np.inf)
