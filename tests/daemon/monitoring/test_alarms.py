"""Alarms are raised for a cause, say what to do, and neither begin nor end with a single second."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.monitoring.alarms import ADVICE, Alarms, wrong_channels
from daemon.reception.channel_watch import ChannelWatch
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
