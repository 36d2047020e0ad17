"""The fitter's own messages: the best so far."""

from collections.abc import Mapping

import numpy as np

from fitter.live.calibration import Calibration
from fitter.search.fitted_parameter import FittedParameter


def kinematics_fields(calibration: Calibration) -> dict[str, object]:
    """Return the fields of `limb/kinematics`; ``error`` is the tip's, rms [m]."""
    fit = calibration.kinematics()
    return {
        "generation": calibration.geometry.generations,
        "frames": calibration.geometry.samples,
        "parameters": {} if fit is None else _parameters(fit.parameters),
        "error": None if fit is None else _number(fit.tip_rms_m),
    }


def dynamics_fields(calibration: Calibration) -> dict[str, object]:
    """Return the fields of `limb/dynamics`; ``error`` is the torque's, rms over samples and joints [N m]."""
    fit = calibration.dynamics
    if fit is None:
        return {"generation": 0, "samples": 0, "parameters": {}, "error": None}
    return {
        "generation": fit.generations,
        "samples": fit.samples,
        "parameters": _parameters(fit.parameters),
        "error": _number(float(np.sqrt(max(fit.cost, 0.0) / max(fit.samples, 1)))),
    }


def _parameters(parameters: Mapping[str, FittedParameter]) -> dict[str, dict[str, float | None]]:
    return {name: {"value": p.value, "std": _number(p.std)} for name, p in parameters.items()}


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None
