"""Eq. (4) and a control law side by side: one equation, homogeneous in base parameters and gains together.

With ``tau = W p`` (eq. (4), (8)) and the law (6), of which (5) and (7) are parts,

    W p - kp (ref - q) - kv dq - ka ddq = 0

holds in every joint at every instant, linear in all that is not known.
"""

from dataclasses import dataclass

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Control, Floats, Law
from arm.regressor import regressor

#: The gains of each law and what each multiplies; the laws from the narrowest form to the widest.
GAINS: dict[Law, tuple[str, ...]] = {"p": ("kp",), "pd": ("kp", "kv"), "pda": ("kp", "kv", "ka")}
TERMS = {"kp": "kp (ref - q)", "kv": "kv dq", "ka": "ka ddq"}
EQUATIONS: dict[Law, str] = {"p": "(7)", "pd": "(5)", "pda": "(6)"}
_UNITS = {True: ("N m/rad", "N m s/rad", "kg m^2"), False: ("N/m", "N s/m", "kg")}


@dataclass(frozen=True)
class LawColumns:
    """The unknowns of an arm under a law: its base parameters, then the law's gains, joint by joint.

    Attributes
    ----------
    law : {"p", "pd", "pda"}
    names, units : tuple of str
        Such as ``I2`` and ``kp1``.
    n_base, n_joint : int
    """

    law: Law
    names: tuple[str, ...]
    units: tuple[str, ...]
    n_base: int
    n_joint: int

    @property
    def kp(self) -> range:
        """Places of kp, one a joint: every law has it."""
        return range(self.n_base, self.n_base + self.n_joint)

    @property
    def gain_names(self) -> tuple[str, ...]:
        """Names of the gains."""
        return self.names[self.n_base :]

    def narrowed(self, law: Law) -> "LawColumns":
        """Return the first of these columns, those of a law whose form is a part of this one's."""
        n = self.n_base + self.n_joint * len(GAINS[law])
        return LawColumns(law, self.names[:n], self.units[:n], self.n_base, self.n_joint)

    def control(self, values: Floats) -> Control:
        """Return the law with the gains among some values, (n_column,)."""
        table = values[self.n_base :].reshape(-1, self.n_joint).tolist()
        return Control(self.law, **{gain: tuple(row) for gain, row in zip(GAINS[self.law], table, strict=True)})

    def law_table(self, values: Floats) -> Floats:
        """Return kp, kv and ka among some values as simulations take them, (3, n_joint)."""
        table = np.zeros((3, self.n_joint))
        table[: len(GAINS[self.law])] = values[self.n_base :].reshape(-1, self.n_joint)
        return table

    def start(self, base_values: Floats, control: Control) -> Floats:
        """Return values from an arm file: base parameters and, where it has them, gains, (n_column,)."""
        table = [getattr(control, gain) or (0.0,) * self.n_joint for gain in GAINS[self.law]]
        return np.concatenate([base_values, np.ravel(table)])


def law_columns(arm: Arm, base: BaseParameters, law: Law = "pda") -> LawColumns:
    """Return the unknowns of an arm under a law."""
    numbers = range(1, arm.n_joint + 1)
    names = [f"{gain}{j}" for gain in GAINS[law] for j in numbers]
    units = [_UNITS[joint.type == "revolute"][k] for k in range(len(GAINS[law])) for joint in arm.joints]
    return LawColumns(law, (*base.names, *names), (*base.units, *units), len(base.names), arm.n_joint)


def law_rows(arm: Arm, base: BaseParameters, q: Floats, dq: Floats, ddq: Floats, error: Floats) -> Floats:
    """Return the columns of eq. (4) and of the law (6), whose product with all values is zero.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity are used.
    base : BaseParameters
    q, dq, ddq, error : (n_sample, n_joint)
        Motion, and ``ref - q``.

    Returns
    -------
    (n_sample, n_joint, n_column)
        Columns as in `law_columns` for ``"pda"``; those of a narrower law come first.
    """
    n_base, n = len(base.independent), arm.n_joint
    rows = np.zeros((*q.shape, n_base + 3 * n))
    rows[..., :n_base] = regressor(arm, q, dq, ddq)[..., base.independent]
    for j in range(n):
        for gain, values in enumerate((error, dq, ddq)):
            rows[:, j, n_base + gain * n + j] = -values[:, j]
    return rows
