"""A sensor that sits elsewhere on its link than was said."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, total, vector, with_sensors
from arm.model import Arm, Effect, Sensor

_AXES = ("x_m", "y_m", "z_m")


def _change(arm: Arm, effect: Effect) -> Arm:
    added = vector(effect.parameters, *_AXES)

    def moved(sensor: Sensor) -> Sensor:
        return replace(sensor, position_m=total(sensor.position_m, added))

    return with_sensors(arm, effect.sensors, moved)


EFFECT = EffectKind(
    name="mounting_radius",
    sentence="the accelerometer sits elsewhere on its link than was said",
    place="sensor",
    parameters=tuple(Parameter(name, "m", -10.0, 10.0, linear=True, neutral=0.0) for name in _AXES),
    taken_for=("sensor_scale",),
    change=_change,
)
