"""The calibrated arm as its file holds it: written only if the file gives back what was printed."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from arm.arm_file import format_arm, parse_arm, save_arm
from arm.base_parameters import BaseParameters
from arm.model import Arm
from arm.regressor import standard_parameters
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import Unusable

#: A file's parameter may differ from what was printed by this fraction of its standard error, or of the largest
#: parameter of its unit: a tenth of the last digit that is printed, and what rounding leaves of a sum of masses.
_OF_STD, _OF_LARGEST = 0.05, 1e-6


def determined_by_data(fit: DynamicsFit) -> dict[str, FittedParameter]:
    """Return the base parameters of a fit that its data determines: what is printed as known."""
    return {name: fit.parameters[name] for name in fit.base.names if fit.parameters[name].identifiable}


def save_calibrated(arm: Arm, base: BaseParameters, printed: Mapping[str, FittedParameter], path: Path) -> None:
    """Write a calibrated arm after making sure that its file gives back the base parameters that are printed.

    Parameters
    ----------
    arm : Arm
        The calibrated arm.
    base : BaseParameters
        The combinations that were learnt.
    printed : mapping of str to FittedParameter
        What is said of them, by name; others are passed over.
    path : Path

    Raises
    ------
    Unusable
        If no links of an arm file have these parameters. Nothing is written then.
    DeviceError
        If the file cannot be written.
    """
    wrong = differing(parse_arm(format_arm(arm), str(path)), base, printed)
    if wrong:
        raise Unusable(
            f"{path}: is not written: no links of an arm file have {', '.join(wrong)} as printed; check the "
            "masses that arm and --fix give"
        )
    save_arm(arm, path)


def differing(arm: Arm, base: BaseParameters, printed: Mapping[str, FittedParameter]) -> list[str]:
    """Return the names of base parameters that an arm does not have as they are printed."""
    values = dict(zip(base.names, (base.combination @ standard_parameters(arm)).tolist(), strict=True))
    largest: dict[str, float] = {}
    for name in base.names:
        if name in printed:
            unit = printed[name].unit
            largest[unit] = max(largest.get(unit, 0.0), abs(printed[name].value))
    return [
        name
        for name, value in values.items()
        if name in printed and not abs(value - printed[name].value) <= _allowed(printed[name], largest)
    ]


def _allowed(parameter: FittedParameter, largest: Mapping[str, float]) -> float:
    std = parameter.std if np.isfinite(parameter.std) else 0.0
    return max(_OF_STD * std, _OF_LARGEST * largest[parameter.unit])
