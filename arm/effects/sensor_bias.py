"""An accelerometer's zero that is off."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, total, vector, with_sensors
from arm.model import Arm, Effect, Sensor

_AXES = ("x_m_s2", "y_m_s2", "z_m_s2")


def _change(arm: Arm, effect: Effect) -> Arm:
    added = vector(effect.parameters, *_AXES)

    def biased(sensor: Sensor) -> Sensor:
        return replace(sensor, bias_m_s2=total(sensor.bias_m_s2, added))

    return with_sensors(arm, effect.sensors, biased)


EFFECT = EffectKind(
    name="sensor_bias",
    sentence="the accelerometer's zero is off",
    place="sensor",
    parameters=tuple(Parameter(name, "m/s^2", -100.0, 100.0, linear=True, neutral=0.0) for name in _AXES),
    taken_for=("sensor_drift", "sensor_highpass", "sensor_misalignment"),
    change=_change,
)
