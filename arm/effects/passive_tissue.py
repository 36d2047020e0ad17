r"""Ligaments, capsule and untensed muscles that stiffen towards one end of a joint's range.

The exponential moment of one end, as in Riener and Edrich (1999) and Anderson and Pandy (1999), stated at an angle
``q_e``, with damping in proportion to it (Hunt and Crossley 1975):

.. math:: M = M_e\, e^{\lambda s (q - q_e)} (s + c \dot q)

``side`` s is +1 where it resists forwards, -1 backwards: both ends of a range are two entries. Where the moment is
stated is a convention, no freedom of its own.
"""

from math import exp

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DQ, Numbers, Q, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[1] * exp(p[2] * p[4] * (x[Q] - p[0])) * (p[4] + p[3] * x[DQ])


EFFECT = EffectKind(
    name="passive_tissue",
    sentence="tissue stiffens towards the end of the joint's range",
    place="joint",
    parameters=(
        Parameter("angle_rad", "rad", -10.0, 10.0),
        Parameter("moment_N_m", "N m", 0.0, 1e4, linear=True, neutral=0.0),
        Parameter("rate_1_rad", "1/rad", 1.0, 100.0),  # measured: 1.7 (hip, extended) to 70 (toes)
        Parameter("damping_s", "s", 0.0, 10.0),
        Parameter("side", "1", -1.0, 1.0),
    ),
    taken_for=("end_stop", "joint_spring"),
    is_living=True,
    stated_at="angle_rad",
    torque=_torque,
)
