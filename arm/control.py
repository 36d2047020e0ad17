"""The control laws (5), (6) and (7): what drives the arm where nobody measures its torque."""

import numpy as np

from arm.model import Control, Floats
from limbcal.errors import ConfigError


def gains(control: Control, n_joint: int) -> Floats:
    """Return kp, kv and ka, one column a joint, zero where the law has none.

    Returns
    -------
    (3, n_joint)

    Raises
    ------
    ConfigError
        If the law is "measured", or a gain is not given for every joint.
    """
    if control.law == "measured":
        raise ConfigError("control.law is 'measured', which gives no torque; expected 'pd', 'pda' or 'p'")
    table = np.zeros((3, n_joint))
    used = {"pd": ("kp", "kv"), "pda": ("kp", "kv", "ka"), "p": ("kp",)}[control.law]
    for row, name in enumerate(("kp", "kv", "ka")):
        if name in used:
            values = getattr(control, name)
            if len(values) != n_joint:
                raise ConfigError(f"control.{name} has {len(values)} numbers, expected one a joint ({n_joint})")
            table[row] = values
    return table


def control_torque(control: Control, q: Floats, dq: Floats, ddq: Floats, ref: Floats) -> Floats:
    """Return the torque that a control law asks for, eq. (5), (6), (7).

    Parameters
    ----------
    control : Control
    q, dq, ddq, ref : (n_sample, n_joint)

    Returns
    -------
    (n_sample, n_joint) [N m or N]

    Raises
    ------
    ConfigError
        If the law is "measured", or a gain is not given for every joint.
    """
    kp, kv, ka = gains(control, q.shape[-1])
    tau: Floats = kp * (ref - q) + kv * dq + ka * ddq  # eq. (6), of which (5) and (7) are parts
    return tau
