"""Velocities and accelerations that count the other way round than the angles: they are derived anew."""

from dataclasses import replace

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import rate_ratio
from limbcal.note import Note


def look(motion: Measured, _arm: Arm) -> Measured:
    """Return the motion without rates that contradict the slope of what they are of by their sign."""
    for of, rate, spoilt in (("q", "dq", ("dq", "ddq")), ("dq", "ddq", ("ddq",))):
        ratios = rate_ratio(motion, of, rate)
        if ratios is None or not (turned := np.flatnonzero(ratios < 0.0)).size:
            continue
        dropped = [role for role in spoilt if role in motion.columns]
        names = tuple(f"{rate}{j + 1}" for j in turned.tolist())
        said = (
            f"{' and '.join(names)} count{'s' if len(names) == 1 else ''} the other way round than the slope of "
            f"{of}: is the sign of one of them turned round? {' and '.join(dropped)} derived anew"
        )
        columns = {role: values for role, values in motion.columns.items() if role not in dropped}
        note = Note("sign", said, columns=names, row=motion.first_row + 1, from_s=float(motion.t[0]))
        motion = replace(motion, columns=columns, notes=(*motion.notes, note))
    return motion
