"""An AC-coupled sensor, which forgets slow motion."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, number, with_sensors
from arm.model import Arm, Effect, Sensor


def _change(arm: Arm, effect: Effect) -> Arm:
    def coupled(sensor: Sensor) -> Sensor:
        return replace(sensor, highpass_hz=number(effect.parameters, "corner_hz"))

    return with_sensors(arm, effect.sensors, coupled)


EFFECT = EffectKind(
    name="sensor_highpass",
    sentence="the accelerometer is AC-coupled and forgets slow motion",
    place="sensor",
    parameters=(Parameter("corner_hz", "Hz", 0.0, 1e3, neutral=0.0),),
    taken_for=("sensor_bias",),
    change=_change,
    absolute=True,
)
