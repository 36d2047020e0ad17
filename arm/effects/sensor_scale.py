"""An accelerometer's axis that reads too much or too little."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, vector, with_sensors
from arm.model import Arm, Effect, Sensor


def _change(arm: Arm, effect: Effect) -> Arm:
    x, y, z = vector(effect.parameters, "x", "y", "z")

    def scaled(sensor: Sensor) -> Sensor:
        return replace(sensor, scale=(x * sensor.scale[0], y * sensor.scale[1], z * sensor.scale[2]))

    return with_sensors(arm, effect.sensors, scaled)


EFFECT = EffectKind(
    name="sensor_scale",
    sentence="the accelerometer reads too much or too little",
    place="sensor",
    parameters=tuple(Parameter(name, "1", 1e-3, 100.0, linear=True, neutral=1.0) for name in ("x", "y", "z")),
    taken_for=("mounting_radius", "sensor_clipping", "sensor_misalignment"),
    change=_change,
)
