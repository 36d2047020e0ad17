"""What is wrong with a virtual device, and when: ``unplug@5+1/3, flip@0+60*1e-5``.

Each fault is ``KIND@START[+SECONDS][*VALUE][/EVERY]``: from START on, for SECONDS, with a value, and again
with period EVERY [s]; all by the host's clock, counted from START of the stream.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from limbcal.errors import ConfigError


@dataclass(frozen=True)
class FaultKind:
    """What a fault does.

    Attributes
    ----------
    sentence : str
        For people.
    value : float or None
        What is taken where no value is given; None where there is none.
    """

    sentence: str
    value: float | None = None


KINDS = {
    "unplug": FaultKind("the cable is pulled, and plugged in again when the time is over; the device goes on"),
    "restart": FaultKind("the device is without power: its clock and its numbers begin anew"),
    "silent": FaultKind("the device samples and sends nothing"),
    "garbage": FaultKind("random bytes between frames, a rate [1/s]", 1000.0),
    "flip": FaultKind("bits turn over, with this probability a byte", 1e-5),
    "drop": FaultKind("frames never leave the device, with this probability each", 0.01),
    "double": FaultKind("frames are sent twice, with this probability each", 0.01),
    "reorder": FaultKind("a frame overtakes the one before it, with this probability", 0.01),
    "baud": FaultKind("the device sends at another rate: every byte is wrong"),
    "stranger": FaultKind("another device is on the port"),
}
#: Duration of a fault that has none of its own [s].
_MOMENT_S = 0.1
_NUMBER = r"\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?"
_FAULT = re.compile(
    rf"(?P<kind>[a-z]+)@(?P<start>{_NUMBER})(?:\+(?P<lasts>{_NUMBER}))?"
    rf"(?:\*(?P<value>{_NUMBER}))?(?:/(?P<every>{_NUMBER}))?"
)


@dataclass(frozen=True)
class Fault:
    """One entry of the schedule; times in seconds since START."""

    kind: str
    start_s: float
    lasts_s: float
    value: float
    every_s: float | None

    def acts(self, at_s: float) -> bool:
        """Say whether it acts at a time."""
        since_s = at_s - self.start_s
        if self.every_s is not None and since_s >= 0.0:
            since_s %= self.every_s
        return 0.0 <= since_s < self.lasts_s


def faults_of(text: str) -> tuple[Fault, ...]:
    """Return the faults of a schedule.

    Raises
    ------
    ConfigError
        With every entry that is none.
    """
    mistakes: list[str] = []
    faults: list[Fault] = []
    for entry in filter(None, (part.strip() for part in text.split(","))):
        match = _FAULT.fullmatch(entry)
        kind = None if match is None else KINDS.get(match["kind"])
        if match is None or kind is None:
            mistakes.append(
                f"--fault {entry!r} is no fault, expected KIND@START[+SECONDS][*VALUE][/EVERY] "
                f"with a kind of {', '.join(KINDS)}"
            )
            continue
        if match["value"] is not None and kind.value is None:
            mistakes.append(f"--fault {entry!r} has a value, expected none for {match['kind']}")
            continue
        lasts_s, every_s = float(match["lasts"] or _MOMENT_S), float(match["every"] or "inf")
        if every_s <= lasts_s:
            mistakes.append(f"--fault {entry!r} comes again before it is over, expected less than {every_s:g} s")
            continue
        faults.append(
            Fault(
                match["kind"],
                float(match["start"]),
                lasts_s,
                float(match["value"] or kind.value or 0.0),
                None if match["every"] is None else every_s,
            )
        )
    if mistakes:
        raise ConfigError(mistakes)
    return tuple(faults)


def acting(faults: Sequence[Fault], at_s: float) -> dict[str, float]:
    """Return the kinds that act at a time, with their values."""
    return {fault.kind: fault.value for fault in faults if fault.acts(at_s)}
