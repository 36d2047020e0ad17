"""A sensor that is mounted turned."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, total, vector, with_sensors
from arm.model import Arm, Effect, Sensor

_ANGLES = ("roll_rad", "pitch_rad", "yaw_rad")


def _change(arm: Arm, effect: Effect) -> Arm:
    added = vector(effect.parameters, *_ANGLES)

    def turned(sensor: Sensor) -> Sensor:
        return replace(sensor, rotation_rad=total(sensor.rotation_rad, added))

    return with_sensors(arm, effect.sensors, turned)


EFFECT = EffectKind(
    name="sensor_misalignment",
    sentence="the accelerometer is mounted turned",
    place="sensor",
    parameters=tuple(Parameter(name, "rad", -3.2, 3.2, neutral=0.0) for name in _ANGLES),
    taken_for=("gravity_tilt", "joint_zero", "sensor_bias", "sensor_scale"),
    change=_change,
)
