"""A gain other than was said: of the controller, the amplifier or the motor's torque constant."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import FACTOR

EFFECT = EffectKind(
    name="gain_error",
    sentence="the joint gets another share of the torque that is asked for: some gain is not what was said",
    place="drive",
    parameters=(Parameter("factor", "1", 0.0, 100.0, linear=True, neutral=1.0),),
    taken_for=("load_friction", "payload", "rotor_inertia", "torque_saturation"),
    simulated={FACTOR: "factor"},
)
