"""Which columns of the standard regressor stand for the base parameters that are sought."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm
from fitter.dynamics.structure import structural_parameters


class BaseColumns:
    """The base parameters that are sought, in any gravity.

    Parameters
    ----------
    arm : Arm
        As its file has it.
    denied : tuple of str
        Beginnings of names of base parameters that are left out, such as ``D`` and ``fc``.
    known : (column, value), optional
        A standard parameter that is not sought.
    """

    def __init__(self, arm: Arm, denied: tuple[str, ...], known: tuple[int, float] | None) -> None:
        self.arm, self.denied, self.known = arm, denied, known
        self._independent: dict[tuple[float, ...], NDArray[np.intp]] = {}

    def of(self, arm: Arm) -> NDArray[np.intp]:
        """Return the columns of the standard regressor that stand for an arm's base parameters."""
        key = (*np.sign(arm.gravity_m_s2), *(np.sign(np.subtract(arm.gravity_m_s2, self.arm.gravity_m_s2))))
        if key not in self._independent:
            x, y, z = (
                float(g if g == g0 else g0 + 0.7 + 0.1 * k)
                for k, (g, g0) in enumerate(zip(arm.gravity_m_s2, self.arm.gravity_m_s2, strict=True))
            )
            base = structural_parameters(replace(arm, gravity_m_s2=(x, y, z)))
            kept = [
                column
                for column, name in zip(base.independent, base.names, strict=True)
                if not any(name.rstrip("0123456789") == start for start in self.denied)
                and not (self.known is not None and column == self.known[0])
            ]
            self._independent[key] = np.array(kept)
        return self._independent[key]
