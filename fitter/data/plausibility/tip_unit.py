"""A tip in millimetres where metres are expected."""

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import path_lengths, reach, turning
from fitter.data.plausibility.refusal import Refusal
from protocol.tables.magnitude import REACH_RATIO, Size, likely

_UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
#: Trackers and CAD give millimetres; one file in centimetres comes on some ten of them.
_RARER = np.log(10.0)
#: How far arms reach whose file knows no length: 0.1 to 2.5 m, a finger's length to a large robot's.
_REACH = Size(0.5, 0.35)


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion, or refuse it where its tip is not in metres.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    tip = motion.columns.get("tip")
    if tip is None or len(tip) < 3 or {"tipx", "tipy", "tipz"} & motion.stated or not turning(arm).all():
        return motion
    turned = float(path_lengths(motion.columns["q"]).sum())
    travelled = float(np.linalg.norm(path_lengths(tip)))
    if not turned > 0.0:
        return motion
    size = Size(reach(arm), REACH_RATIO.decades) if reach(arm) > 0.0 else _REACH
    weight = {unit: size.log_likelihood(travelled / turned * scale) for unit, scale in _UNITS.items()}
    weight["cm"] -= _RARER
    unit = likely(weight, "m")
    if unit is None:
        return motion
    span = float(np.ptp(tip, axis=0).max())
    named = {"mm": "millimetres", "cm": "centimetres"}[unit]
    raise Refusal(
        f"{motion.where}: the tip moves over {span:.4g} m, and arm {arm.name} reaches {reach(arm):.3g} m: is it "
        f'in {named}? Expected metres, or the unit stated, as in --columns "tipx=tipx:{unit},tipy=tipy:{unit},'
        f'tipz=tipz:{unit}"'
    )
