"""A transmission that twists: ``k x + d x'`` is the torque it transmits, x what the motor's side leads by.

The angle that is measured and controlled is the motor's; the motor has no inertia.
"""

import math

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import DAMPING, STIFFNESS

EFFECT = EffectKind(
    name="joint_elasticity",
    sentence="the transmission twists under load",
    place="transmission",
    parameters=(
        Parameter("stiffness_N_m_rad", "N m/rad", 1.0, 1e7, neutral=math.inf),
        Parameter("damping_N_m_s", "N m s/rad", 0.0, 1e4),
    ),
    taken_for=("actuator_delay", "actuator_lag", "backlash", "viscous"),
    simulated={STIFFNESS: "stiffness_N_m_rad", DAMPING: "damping_N_m_s"},
)
