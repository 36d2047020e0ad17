"""What the effects of an arm do to its sensors' readings, block by block."""

from typing import Literal

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind, Reading, number
from arm.effects.time_skew import Skew
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Effect, Floats

#: Where on its way to the reading an effect acts: on the force that is felt, on what the sensor makes of it, or on
#: that with its noise.
Stage = Literal["force", "reading", "converted"]


class SensorEffects:
    """The effects that are no numbers of a sensor's own, over readings that follow each other.

    Parameters
    ----------
    arm : Arm
        With its effects, and its sensors as they sit.
    rate_hz : float
    """

    def __init__(self, arm: Arm, rate_hz: float) -> None:
        self._arm, self._rate_hz, self._samples = arm, rate_hz, 0
        names = [sensor.name for sensor in arm.sensors]
        self._acting: list[tuple[EffectKind, Effect, list[int]]] = []
        self._late: list[tuple[int, Skew]] = []
        for effect in arm.effects:
            kind = catalogue()[effect.name]
            on = list(range(len(names))) if kind.whole else [names.index(name) for name in effect.sensors]
            if kind.late:
                delay = number(effect.parameters, kind.late) * rate_hz
                self._late += [(s, Skew(delay)) for s in on]
            elif kind.place == "sensor":
                self._acting.append((kind, effect, on))

    def felt(self, a: Floats, q: Floats) -> Floats:
        """Return what sensors feel in place of the specific force (n_sample, n_sensor, 3) of a motion's next part.

        ``q`` (n_sample, n_joint) are the links' angles.
        """
        a = self._at("force", a, q)
        for s, skew in self._late:
            a[:, s] = skew.apply(a[:, s])
        return a

    def read(self, a: Floats) -> Floats:
        """Return what sensors make of it."""
        return self._at("reading", a)

    def converted(self, a: Floats) -> Floats:
        """Return what comes of readings with their noise; the next part follows."""
        a = self._at("converted", a)
        self._samples += len(a)
        return a

    def _at(self, stage: Stage, a: Floats, q: Floats | None = None) -> Floats:
        acting = [(getattr(kind, stage), effect, on) for kind, effect, on in self._acting]
        acting = [(change, effect, on) for change, effect, on in acting if change is not None]
        if not acting:
            return a
        t = (self._samples + np.arange(len(a))) / self._rate_hz
        frames = None if q is None else axis_frames(self._arm, q)[..., :3, :3]
        change: Reading
        for change, effect, on in acting:
            for s in on:
                axes = np.empty((0, 3, 3))
                if frames is not None:
                    sensor = self._arm.sensors[s]
                    axes = frames[:, sensor.joint - 1] @ rotation_from_rpy(*sensor.rotation_rad)
                a[:, s] = change(a[:, s], t, axes, effect.parameters)
        return a
