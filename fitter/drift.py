"""Taking the drift out of dead reckoning, once the rest at the end of a motion is known.

Between two rests an offset that is left over, and most of the noise, act like a constant error of acceleration.
At the end the arm stands still, so whatever velocity is left then is that error times the duration: it is taken
out as ``c t^2 / 2`` of position, ``c t`` of velocity and ``c`` of acceleration. Where the motion ends elsewhere
than the tracker had thought, what follows starts there too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fitter.motions import Measured
from fitter.tables import Floats

#: The velocity that is left is averaged over this long before the end [s].
_LAST_S = 0.02
#: Derivatives of each dead-reckoned column, lowest first.
_COLUMNS = (("q", "dq", "ddq"), ("points",))


@dataclass
class DriftCorrection:
    """Takes the drift out of one motion after the other; each begins where the one before really ended.

    Attributes
    ----------
    shift : dict of str to ndarray
        What the motions so far have added to q and points, without truth in it.
    """

    shift: dict[str, Floats] = field(default_factory=dict)

    def apply(self, motion: Measured) -> Measured:
        """Return a motion, from rest to rest, without drift.

        Parameters
        ----------
        motion : Measured
            Evenly sampled, with q, dq, ddq (n, n_joint) and where known points (n, n_sensor, 3).
        """
        t = motion.t - motion.t[0]
        if len(t) < 3:
            return motion
        columns = dict(motion.columns)
        for names in _COLUMNS:
            if names[0] in columns:
                columns |= self._corrected(t, names, columns)
        return replace(motion, columns=columns, notes=(*motion.notes, "drift taken out by the rest at the end"))

    def _corrected(self, t: Floats, names: tuple[str, ...], columns: Mapping[str, Floats]) -> dict[str, Floats]:
        position = columns[names[0]]
        last = min(max(1, int(_LAST_S * (len(t) - 1) / t[-1])), len(t) - 2)
        left = (position[-2] - position[-2 - last]) / (t[-2] - t[-2 - last])
        c = left / t[-1]
        s = t.reshape(-1, *[1] * (position.ndim - 1))
        errors = (c * s**2 / 2, c * s, c + 0 * s)
        shift = self.shift.get(names[0], np.zeros_like(position[0]))
        self.shift[names[0]] = shift + errors[0][-1]
        corrected = {name: columns[name] - error for name, error in zip(names, errors, strict=False)}
        corrected[names[0]] = corrected[names[0]] - shift
        return corrected
