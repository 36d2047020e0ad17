"""Numbers that are known of an arm and its law, and those that are taken where nothing is."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from arm.model import Arm
from fitter.controller.law_ambiguity import LawNullSpace
from fitter.controller.law_columns import LawColumns
from fitter.controller.law_equations import LawEquations
from fitter.controller.law_fit import equations_gram
from limbcal.errors import ConfigError


def fixed_parameters(
    arm: Arm, columns: LawColumns, fixed: Mapping[str, float], free_gains: Collection[str] | None
) -> dict[str, float]:
    """Return what is known beforehand: what is given, and the arm file's gains that are not free.

    Raises
    ------
    ConfigError
        If a name is not that of a gain or base parameter, or is given twice, or a kp is fixed to zero.
    """
    unknown = sorted({*fixed, *(free_gains or ())} - set(columns.names))
    if unknown:
        raise ConfigError(
            f"nothing is called {', '.join(unknown)}; expected a gain or base parameter of "
            f"{', '.join(columns.names)}"
        )
    both = sorted(set(fixed) & set(free_gains or ()))
    if both:
        raise ConfigError(f"{', '.join(both)} is both fixed and free; expected one of them")
    known = dict(fixed)
    if free_gains is not None:
        start = columns.start(np.zeros(columns.n_base), arm.control)
        known |= {
            name: float(start[columns.n_base + k])
            for k, name in enumerate(columns.gain_names)
            if name not in free_gains and name not in fixed
        }
    wrong = [columns.names[k] for k in columns.kp if known.get(columns.names[k]) == 0.0]
    if wrong:
        raise ConfigError(f"{', '.join(wrong)} is fixed to 0, expected a gain that drives the joint")
    return known


def anchors_of(arm: Arm, columns: LawColumns, trials: Sequence[LawEquations]) -> tuple[tuple[str, float], ...]:
    """Return the arm file's kp for every factor: what is taken where nothing is known."""
    start = columns.start(np.zeros(columns.n_base), arm.control)
    leaders = LawNullSpace(columns, equations_gram(trials)).given(()).leaders
    missing = [columns.names[k] for k in leaders if start[k] == 0.0]
    if missing:
        raise ConfigError(
            f"nothing is known and arm {arm.name} has no {', '.join(missing)}; expected a known gain"
        )
    return tuple((columns.names[k], float(start[k])) for k in leaders)
