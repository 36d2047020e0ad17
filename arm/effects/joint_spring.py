"""Something elastic that pulls the joint to a rest angle: a cable, a hose, tissue."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, Q, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * (x[Q] - p[1])


EFFECT = EffectKind(
    name="joint_spring",
    sentence="something elastic pulls the joint to a rest angle",
    place="joint",
    parameters=(
        Parameter("stiffness_N_m_rad", "N m/rad", 0.0, 1e4, linear=True, neutral=0.0),
        Parameter("rest_angle_rad", "rad", -10.0, 10.0),
    ),
    taken_for=("end_stop", "gravity_tilt", "joint_zero", "passive_tissue", "torque_offset"),
    torque=_torque,
)
