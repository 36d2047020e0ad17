"""From where on a channel's readings are wrong, and in what words."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from daemon.monitoring.alarms import Alarms, still_axes, wrong_channels
from daemon.reception.channel_watch import Reading

NAMES = [f"s{k}{axis}" for k in (1, 2) for axis in "xyz"]
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


def test_sensors_at_rest_are_right() -> None:
    assert wrong_channels(NAMES, reading()) == {}
    assert wrong_channels(NAMES, replace(reading(), samples=0, clipped=counted(0, 7))) == {}


@pytest.mark.parametrize(
    ("changed", "wrong"),
    [
        ({"clipped": counted(1, 1)}, {("clipped", "s1y"): "1 samples in the last second"}),
        ({"saturated": counted(3, 2)}, {("saturated", "s2x"): "2 samples beyond the range in the last second"}),
        ({"flat": counted(2, 500)}, {}),
        ({"flat": counted(2, 501)}, {("flat", "s1z"): "it stood still in the last second"}),
        ({"noise": at(4, 0.05, [0.01] * 6)}, {}),
        ({"noise": at(4, 0.0501, [0.01] * 6)}, {("noisy", "s2y"): "0.05 m/s^2 rms, the others 0.01"}),
        ({"noise": at(4, 0.5, [0.0] * 6)}, {}),
        ({"mean": np.array([0, 0, 1.0799 * G, 0, 0, G])}, {}),
        ({"mean": np.array([0, 0, 1.0801 * G, 0, 0, G])}, {("gravity", "s1"): "10.59 m/s^2 at rest"}),
        ({"mean": np.array([0, 0, G, 0, 0, -0.9201 * G])}, {}),
        ({"mean": np.array([0, 0, G, 0, 0.9199 * G, 0])}, {("gravity", "s2"): "9.02 m/s^2 at rest"}),
        ({"mean": np.array([0.6 * G, 0, 0.8 * G, 0, 0, G])}, {}),
        ({"mean": np.array([0, 0, 2.0 * G, 0, 0, G]), "spread": at(0, 0.07)}, {}),  # it moves
        (
            {"mean": np.array([0, 0, 2.0 * G, 0, 0, G]), "spread": at(3, 9.0)},
            {("gravity", "s1"): "19.61 m/s^2 at rest"},
        ),
    ],
)
def test_what_a_channel_may_read(changed: dict[str, np.ndarray], wrong: dict[tuple[str, str], str]) -> None:
    assert wrong_channels(NAMES, replace(reading(), **changed)) == wrong  # type: ignore[arg-type]


def test_of_what_is_wrong_with_a_channel_the_worst_is_told() -> None:
    all_of_it = {"clipped": counted(0, 1), "saturated": counted(0, 2), "flat": counted(0, 1001)}
    worst = []
    for gone in ("clipped", "saturated", "flat"):
        (key,) = wrong_channels(NAMES, replace(reading(), **all_of_it))  # type: ignore[arg-type]
        worst.append(key)
        all_of_it[gone] = NONE
    assert worst == [("clipped", "s1x"), ("saturated", "s1x"), ("flat", "s1x")]


@pytest.mark.parametrize(("first", "axis"), [(0, 0), (0, 2), (3, 3), (3, 5)])
@pytest.mark.parametrize(("spread", "still"), [(0.0699, True), (0.0701, False)])
def test_a_sensor_is_still_within_its_noise_and_a_little(
    first: int, axis: int, spread: float, still: bool
) -> None:
    """Twice its noise of 0.01, and 0.05 m/s^2; the other sensor's axes do not matter."""
    one = replace(reading(), spread=at(axis, spread))
    assert still_axes(one, first) == still
    assert still_axes(one, 3 - first)
    assert not still_axes(replace(one, samples=0), first)


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


def test_an_alarm_of_the_whole_names_no_subject() -> None:
    alarms = Alarms()
    for k in range(2):
        begun, _ = alarms.report({("behind", ""): "late"}, k)
    assert begun[0].sentence.startswith("behind: late; the machine is too slow")


def test_an_alarm_ends_after_five_reports_in_a_row_without_its_cause() -> None:
    alarms, key = Alarms(), ("flat", "s1x")
    for k in range(2):
        alarms.report({key: "it"}, k)
    for misses in (4, 4, 5):
        gone = [alarms.report({}, 9)[1] for _ in range(misses)]
        assert [len(one) for one in gone] == [0] * 4 + [1] * (misses - 4)
        if misses == 4:
            assert alarms.report({key: "it"}, 9) == ([], [])
    assert alarms.raised == {} and gone[-1][0].found == "it"
    assert alarms.report({key: "it"}, 9) == ([], [])  # and needs two reports again


def test_a_cause_that_is_shown_every_other_report_raises_nothing() -> None:
    alarms, key = Alarms(), ("flat", "s1x")
    for _ in range(3):
        assert alarms.report({key: "it"}, 0) == ([], []) and alarms.report({}, 0) == ([], [])
