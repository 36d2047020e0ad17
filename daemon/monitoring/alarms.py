"""Alarms: what is wrong, since when, and what to do about it; neither raised nor ended by a single second."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import STANDARD_GRAVITY_M_S2
from daemon.reception.channel_watch import Reading

#: Reports in a row, one a second, that raise an alarm, and that end it: a single second does neither. Conventions.
_RAISED_BY, _ENDED_BY = 2, 5
#: This many times the median noise of all channels is no noise of the same kind of sensor [1]: a convention.
_NOISY = 5.0
#: A sensor rests while it moves by no more than its noise and this [m/s^2]; by this fraction of g it may then be
#: off. Both are conventions.
_STILL_M_S2, _IMPLAUSIBLE = 0.05, 0.08

#: What to do, by alarm.
ADVICE = {
    "saturated": "choose a larger range, or mount the sensor nearer to the joint",
    "clipped": "the converter is at its end: choose a larger range",
    "flat": "the axis reads the same all the time: look at its cable and its supply",
    "noisy": "the axis is far noisier than the others: look at its cable, its shield and how it is mounted",
    "gravity": "a resting sensor must read 9.81 m/s^2 in all: look at its scale in the device, and its axes",
    "contradiction": "the readings contradict the arm file: did a sensor come loose? `fitter sensors` finds out",
    "disconnected": "the device is gone: look at its cable and its supply; it is taken up again by itself",
    "stranger": "another device is on the port: plug the first one in, or start limbd anew to accept this one",
    "garbage": "bytes come and no frame: look at the baud rate and the cable",
    "nonsense": "frames come whole and say what no device may: docs/protocol.md has what its firmware must",
    "losses": "samples are lost: look at limb/gap for why; a shorter cable or a slower rate may help",
    "behind": "the machine is too slow for this rate, or something else takes its processors",
    "rate": "what is measured is followed, and no sample is lost by it",
    "clock": "stamps go on by this machine's clock as it was when the run began, and by the frames' numbers",
    "disk": "the disk is nearly full: make room, or recording will pause",
    "not recorded": "make room on the disk, or its folder anew; recording then goes on by itself",
    "removed": "files of the recording were taken away: it goes on in a new one; who tidies up there?",
}


@dataclass(frozen=True)
class Alarm:
    """One that is raised.

    Attributes
    ----------
    name : str
        A key of `ADVICE`.
    subject : str
        The channel or sensor, empty where it is the whole.
    since_ns : int
        UTC of the report that raised it.
    found : str
        What was found, by the last report that shows it.
    """

    name: str
    subject: str
    since_ns: int
    found: str

    def document(self) -> dict[str, object]:
        """Return it as a message has it."""
        fields = {"name": self.name, "subject": self.subject, "since_ns": self.since_ns, "found": self.found}
        return {**fields, "do": ADVICE[self.name]}

    @property
    def sentence(self) -> str:
        """What was found and what to do."""
        return f"{self.name}{' ' * bool(self.subject)}{self.subject}: {self.found}; {ADVICE[self.name]}"


#: What is wrong, by alarm and subject, in words.
Wrong = Mapping[tuple[str, str], str]


class Alarms:
    """Keeps the alarms of a run.

    Attributes
    ----------
    raised : dict of (name, subject) to Alarm
    """

    def __init__(self) -> None:
        self.raised: dict[tuple[str, str], Alarm] = {}
        self._seen: dict[tuple[str, str], int] = {}
        self._missed: dict[tuple[str, str], int] = {}

    def report(self, wrong: Wrong, now_ns: int) -> tuple[list[Alarm], list[Alarm]]:
        """Take what a report shows; return the alarms that it raises, and those that it ends."""
        begun: list[Alarm] = []
        for key, found in wrong.items():
            self._missed.pop(key, None)
            self._seen[key] = self._seen.get(key, 0) + 1
            if key in self.raised:
                self.raised[key] = replace(self.raised[key], found=found)
            if key not in self.raised and self._seen[key] >= _RAISED_BY:
                self.raised[key] = Alarm(*key, now_ns, found)
                begun.append(self.raised[key])
        ended: list[Alarm] = []
        for key in [key for key in self._seen if key not in wrong]:
            self._missed[key] = self._missed.get(key, 0) + 1
            if key not in self.raised or self._missed[key] >= _ENDED_BY:
                del self._seen[key], self._missed[key]
                if key in self.raised:
                    ended.append(self.raised.pop(key))
        return begun, ended


def wrong_channels(names: Sequence[str], reading: Reading, n_rate: int = 0) -> dict[tuple[str, str], str]:
    """Return what channels show: full scale, the converter's ends, standing still, noise, gravity.

    Parameters
    ----------
    names : sequence of str
        Of the channels; three in a row are a sensor's axes.
    reading : Reading
    n_rate : int
        How many channels, the last ones, are of gyroscopes: they feel no gravity.
    """
    wrong: dict[tuple[str, str], str] = {}
    if reading.samples == 0:
        return wrong
    n_acceleration = len(names) - n_rate
    kinds = (slice(n_acceleration), slice(n_acceleration, None))
    usual_of = [float(np.median(reading.noise[kind])) if names[kind] else 0.0 for kind in kinds]
    for k, name in enumerate(names):
        turning = k >= n_acceleration
        usual, unit = usual_of[turning], "rad/s" if turning else "m/s^2"
        if reading.clipped[k]:
            wrong["clipped", name] = f"{reading.clipped[k]} samples in the last second"
        elif reading.saturated[k]:
            wrong["saturated", name] = f"{reading.saturated[k]} samples beyond the range in the last second"
        elif reading.flat[k] > reading.samples // 2:
            wrong["flat", name] = "it stood still in the last second"
        elif reading.noise[k] > _NOISY * usual > 0.0:
            wrong["noisy", name] = f"{reading.noise[k]:.2g} {unit} rms, the others {usual:.2g}"
    for k in range(0, n_acceleration, 3):
        size = float(np.linalg.norm(reading.mean[k : k + 3]))
        if still_axes(reading, k) and abs(size - STANDARD_GRAVITY_M_S2) > _IMPLAUSIBLE * STANDARD_GRAVITY_M_S2:
            wrong["gravity", names[k][:-1]] = f"{size:.2f} m/s^2 at rest"
    return wrong


def still_axes(reading: Reading, first: int) -> bool:
    """Say whether a sensor, the three axes from ``first`` on, moved by no more than its noise.

    It looks at one sensor alone, in the sums of a whole report, without an arm or a tracker, since it is to find
    sensors that are wrong: the trackers' detectors ask all sensors at once and take them to be right.
    """
    axes = slice(first, first + 3)
    return bool(reading.samples and np.all(reading.spread[axes] < 2.0 * reading.noise[axes] + _STILL_M_S2))
