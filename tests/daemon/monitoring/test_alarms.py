"""Alarms are raised for a cause, say what to do, and neither begin nor end with a single second."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.monitoring.alarms import ADVICE, Alarms, wrong_channels
from daemon.reception.channel_watch import ChannelWatch, Reading
from protocol.device_info import Channel

NAMES = [f"s{k}{axis}" for k in (1, 2) for axis in "xyz"]
SCALE, NOISE = 0.0015, 10.0


def readings(rng: np.random.Generator, n: int = 8000) -> np.ndarray:
    """Return counts of two sensors at rest."""
    counts = NOISE * rng.normal(size=(n, 6))
    counts[:, [2, 5]] += 9.80665 / SCALE
    return counts


def found(counts: np.ndarray) -> set[tuple[str, str]]:
    watch = ChannelWatch([Channel(name, SCALE, 0.0, 40.0) for name in NAMES], 8000.0)
    for part in np.split(np.clip(np.rint(counts), -32768, 32767).astype(np.int16), 80):
        watch.watch(part)
    return set(wrong_channels(NAMES, watch.take()))


def test_sensors_in_order_raise_nothing() -> None:
    rng = np.random.default_rng(0)
    counts = readings(rng)
    assert found(counts) == set()
    t = np.arange(len(counts)) / 8000.0
    assert found(counts + 3000.0 * np.sin(7.0 * t)[:, None]) == set()


@pytest.mark.parametrize(
    ("name", "subject"),
    [("saturated", "s1x"), ("clipped", "s2y"), ("flat", "s1y"), ("noisy", "s2x"), ("gravity", "s2")],
)
def test_what_is_wrong_with_a_channel_is_told(name: str, subject: str) -> None:
    rng = np.random.default_rng(1)
    counts = readings(rng)
    if name == "gravity":
        counts[:, 5] *= 1.2
    else:
        k = NAMES.index(subject)
        change = {"saturated": 40.5 / SCALE, "clipped": 40_000.0, "flat": 0.0, "noisy": 0.0}[name]
        if name in ("saturated", "clipped"):
            counts[1000:1010, k] = change
        elif name == "flat":
            counts[:, k] = 3.0
        else:
            counts[:, k] *= 20.0
    assert found(counts) == {(name, subject)}


@given(st.lists(st.booleans(), max_size=60))
def test_an_alarm_needs_two_reports_and_ends_after_five(shown: list[bool]) -> None:
    alarms, raised, quiet, before = Alarms(), False, 0, False
    for k, wrong in enumerate(shown):
        begun, ended = alarms.report({("flat", "s1x"): "it"} if wrong else {}, k)
        quiet = 0 if wrong else quiet + 1
        expected = (raised or (wrong and before)) and not (raised and quiet >= 5)
        assert bool(begun) == (expected and not raised)
        assert bool(ended) == (raised and not expected)
        raised, before = expected, wrong
        assert bool(alarms.raised) == raised


def test_every_alarm_says_what_to_do() -> None:
    alarms = Alarms()
    wrong = {(name, "s1x"): "something" for name in ADVICE}
    alarms.report(wrong, 1)
    begun, _ = alarms.report(wrong, 2)
    assert len(begun) == len(ADVICE)
    assert all(alarm.document()["do"] and ADVICE[alarm.name] in alarm.sentence for alarm in begun)


G = 9.80665


NONE = np.zeros(6, dtype=np.int64)


def reading() -> Reading:
    """Return what two sensors at rest read: along z, with a noise of 0.01 m/s^2."""
    mean = np.array([0.0, 0.0, G, 0.0, 0.0, G])
    return Reading(1001, mean, np.full(6, 0.01), np.full(6, 0.01), NONE, NONE, NONE)


def at(k: int, value: float, of: Sequence[float] | None = None) -> np.ndarray:
    values = np.array(of if of is not None else np.zeros(6))
    values[k] = value
    return values


def counted(k: int, value: int) -> np.ndarray:
    return at(k, value).astype(np.int64)


@pytest.mark.parametrize(
    ("changed", "wrong"),
    [
        ({"samples": 0, "clipped": counted(0, 7)}, {}),
        ({"clipped": counted(1, 1)}, {("clipped", "s1y"): "1 samples in the last second"}),
        ({"saturated": counted(3, 2)}, {("saturated", "s2x"): "2 samples beyond the range in the last second"}),
        ({"flat": counted(2, 1001)}, {("flat", "s1z"): "it stood still in the last second"}),
        ({"noise": at(4, 0.06, [0.01] * 6)}, {("noisy", "s2y"): "0.06 m/s^2 rms, the others 0.01"}),
        ({"noise": at(4, 0.5, [0.0] * 6)}, {}),  # nothing to compare it with
        ({"mean": np.array([0.6 * G, 0, 0.8 * G, 0, 0, G])}, {}),
        ({"mean": np.array([0, 0, 2.0 * G, 0, 0, G])}, {("gravity", "s1"): "19.61 m/s^2 at rest"}),
        ({"mean": np.array([0, 0, 2.0 * G, 0, 0, G]), "spread": at(0, 0.08)}, {}),  # it moves
        (
            {"mean": np.array([0, 0, 2.0 * G, 0, 0, G]), "spread": at(3, 9.0)},  # the other one moves
            {("gravity", "s1"): "19.61 m/s^2 at rest"},
        ),
    ],
)
def test_what_a_reading_gives_away(changed: dict[str, np.ndarray], wrong: dict[tuple[str, str], str]) -> None:
    assert wrong_channels(NAMES, replace(reading(), **changed)) == wrong  # type: ignore[arg-type]


def test_of_what_is_wrong_with_a_channel_the_worst_is_told() -> None:
    all_of_it = {"clipped": counted(0, 1), "saturated": counted(0, 2), "flat": counted(0, 1001)}
    worst = []
    for gone in ("clipped", "saturated", "flat"):
        (key,) = wrong_channels(NAMES, replace(reading(), **all_of_it))  # type: ignore[arg-type]
        worst.append(key)
        all_of_it[gone] = NONE
    assert worst == [("clipped", "s1x"), ("saturated", "s1x"), ("flat", "s1x")]


def test_an_alarm_tells_since_when_and_what_the_last_report_found() -> None:
    alarms, key = Alarms(), ("flat", "s1x")
    assert alarms.report({key: "one"}, 10) == ([], [])
    begun, ended = alarms.report({key: "two"}, 20)
    assert [(one.name, one.subject, one.since_ns, one.found) for one in begun] == [("flat", "s1x", 20, "two")]
    assert ended == [] and alarms.report({key: "three"}, 30) == ([], [])
    assert alarms.raised[key].found == "three" and alarms.raised[key].since_ns == 20
    document = alarms.raised[key].document()
    assert (document["name"], document["subject"], document["since_ns"], document["found"]) == (
        *("flat", "s1x", 20, "three"),
    )
    assert alarms.raised[key].sentence.startswith("flat s1x: three; the axis reads the same")
    for k in range(2):
        begun, _ = alarms.report({("behind", ""): "late"}, k)
    assert begun[0].sentence.startswith("behind: late; the machine is too slow")
