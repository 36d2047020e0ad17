"""Where searches for psi begin: where others have come to, and at which frequencies what is left swings most."""

from collections.abc import Sequence

import numpy as np
import scipy.signal

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.least_squares import FOREMOST
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.whitening import Whitening


class Starts:
    """Values of psi from which a search has come far: when the same is sought anew, it begins there.

    Where only weights have changed, or the psi of what was accepted, the best of them has hardly moved.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[frozenset[Hypothesis], Hypothesis], Floats] = {}

    def of(self, model: Model, hypothesis: Hypothesis) -> Floats | None:
        """Return those of a hypothesis beside a model's, (n_start, n_psi); None if it was not tried there."""
        return self._known.get((frozenset(model.hypotheses), hypothesis))

    def keep(self, model: Model, hypothesis: Hypothesis, starts: Floats) -> None:
        """Keep those that did best."""
        self._known[frozenset(model.hypotheses), hypothesis] = starts

    def forget(self) -> None:
        """Forget all: they are of other trials."""
        self._known.clear()


def peaks(left: Floats, motions: Sequence[Motion], whitening: Whitening) -> Floats:
    """Return the frequencies at which residuals swing most, (n_peak, 1) [Hz].

    Parameters
    ----------
    left : (n_slower of all motions,)
        Of one joint, one motion after the other.
    motions : sequence of Motion
    whitening : Whitening
        Says what the slower grid is.
    """
    stride = whitening.stride
    ends = np.cumsum([0, *(len(motion.t[::stride]) for motion in motions)])
    span = float(motions[-1].t[-1] - motions[0].t[0])
    f = np.arange(0.05, whitening.band_hz, 0.25 / span)
    swing = np.zeros(len(f), dtype=np.complex128)
    for motion, first, last in zip(motions, ends, ends[1:], strict=False):
        # A chirp transform: as fine as all trials together tell frequencies apart, at their own times.
        spectrum = scipy.signal.zoom_fft(
            left[first:last], [f[0], f[-1]], len(f), fs=1.0 / (stride * motion.dt_s), endpoint=True
        )
        swing += np.exp(-2j * np.pi * f * motion.t[0]) * spectrum
    power = np.abs(swing)
    found: list[float] = []
    for k in np.argsort(power)[::-1]:
        if all(abs(f[k] - other) > 1.0 / span for other in found):
            found.append(float(f[k]))
        if len(found) == FOREMOST:
            break
    return np.array(found)[:, None]
