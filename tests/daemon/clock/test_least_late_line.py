"""The line through the least late arrivals is that of least squares, and which arrivals it goes through."""

import numpy as np
import pytest

from daemon.clock.least_late import LeastLate, Line

STRETCH_S = 1.0 / 16.0


def line_through(late_s: list[float], rate: float = 1.0) -> Line | None:
    """Return the line after stretches of two arrivals each, of which the second is late by so much."""
    arrivals = LeastLate(rate)
    for k, late in enumerate(late_s):
        device_s = 2.0 * k * STRETCH_S
        assert not arrivals.note(device_s, device_s + 9.0)
        assert arrivals.note(device_s + STRETCH_S, device_s + STRETCH_S + late)
    return arrivals.line()


def points(late_s: list[float]) -> tuple[np.ndarray, np.ndarray]:
    device = (2.0 * np.arange(len(late_s)) + 1.0) * STRETCH_S
    return device, device + np.array(late_s)


@pytest.mark.parametrize(
    ("late_s", "outlier"),
    [
        ([0.0, 0.003, 0.001, 0.002], None),
        ([0.0, 0.003, 0.001, 0.002, 0.004, 0.002, 0.0], None),
        ([0.0, 0.003, 0.001, 0.500, 0.002, 0.004, 0.002, 0.0], 3),
        ([0.0, 0.003, 0.001, 0.002, 0.004, 0.002, -0.500, 0.001], 6),
        ([0.0, 0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007], None),
    ],
)
def test_the_line_is_that_of_least_squares_without_what_lies_far_off(
    late_s: list[float], outlier: int | None
) -> None:
    line = line_through(late_s)
    assert line is not None
    device, host = (np.delete(one, outlier) if outlier is not None else one for one in points(late_s))
    slope, offset = np.polyfit(device, host, 1)
    spread = np.sqrt(np.sum((host - offset - slope * device) ** 2) / (len(device) - 2))
    scatter = spread / np.sqrt(np.sum((device - device.mean()) ** 2))
    span = 2.0 * STRETCH_S * (len(late_s) - 1)
    assert line.rate == pytest.approx(slope, abs=1e-12)
    assert line.device_s == pytest.approx(device.mean())
    assert line.host_s == pytest.approx(host.mean())
    assert line.spread_s == pytest.approx(spread, abs=1e-12)
    assert line.scatter_std == pytest.approx(scatter, abs=1e-12)
    assert line.span_s == pytest.approx(span)
    assert line.rate_std == pytest.approx(np.hypot(scatter, 0.010 / 3.0 / span), rel=1e-9)


@pytest.mark.parametrize("far", [True, False])
def test_three_median_distances_are_far_off(far: bool) -> None:
    """Even and odd arrivals lie 1 ms apart, and one further than all of those by three of their distances."""
    late_s = [0.001 * (k % 2) for k in range(14)]
    late_s[7] += 0.003 if far else 0.0012
    line = line_through(late_s)
    assert line is not None
    device, host = points(late_s)
    whole = np.polyfit(device, host, 1)[0]
    without = np.polyfit(np.delete(device, 7), np.delete(host, 7), 1)[0]
    assert line.rate == pytest.approx(without if far else whole, abs=1e-9) and abs(whole - without) > 1e-6


@pytest.mark.parametrize(("count", "known"), [(0, False), (3, False), (4, True)])
def test_four_stretches_make_a_line(count: int, known: bool) -> None:
    assert (line_through([0.001 * (k % 2) for k in range(count)]) is not None) == known


def test_arrivals_on_a_line_are_all_taken() -> None:
    line = line_through([0.25 * k * STRETCH_S for k in range(8)])
    assert line is not None and line.rate == pytest.approx(1.125)
    assert line.spread_s == pytest.approx(0.0, abs=1e-12)


def test_arrivals_at_one_moment_are_no_line() -> None:
    arrivals = LeastLate(1.0)
    arrivals.note(0.0, 0.0)
    for _ in range(4):
        assert not arrivals.note(0.0, 0.0)
    assert arrivals.line() is None


@pytest.mark.parametrize(("rate", "taken"), [(1.0, 1), (2.0, 2), (0.5, 0)])
def test_what_is_late_is_told_by_the_rate_that_is_known(rate: float, taken: int) -> None:
    """Arrivals are as far apart by both clocks, but for the one that is to be taken."""
    arrivals, step_s = LeastLate(rate), 0.02
    for k in range(8):
        begin_s = 0.125 * k
        for i in range(4):
            device_s = begin_s + step_s * i + 0.01 * (i == 3)
            arrivals.note(device_s, rate * device_s + 0.001 * (i != taken))
    line = arrivals.line()
    assert line is not None
    assert line.rate == pytest.approx(rate)
    assert line.device_s == pytest.approx(np.mean([0.125 * k + step_s * taken for k in range(8)]))


def test_of_arrivals_that_are_as_late_the_last_counts() -> None:
    arrivals = LeastLate(1.0)
    for k in range(4):
        for i in (0, 1, 2):
            arrivals.note(0.125 * k + 0.03125 * i, 0.125 * k + 0.03125 * i)
    line = arrivals.line()
    assert line is not None and line.device_s == pytest.approx(0.0625 + np.mean([0.0, 0.125, 0.25, 0.375]))


def test_stretches_grow_as_they_become_many() -> None:
    """By sixteenths of a second: sixteen short ones are joined to eight, 256 of a second to 128 of two."""
    arrivals, lengths, length = LeastLate(1.0), list[int](), 0
    for k in range(26_000):
        length += 1
        if arrivals.note(k * STRETCH_S, k * STRETCH_S):
            lengths.append(length)
            length = 0
    expected = 16 * [2] + 8 * [3] + 8 * [5] + 8 * [9] + 248 * [17] + 128 * [33]
    assert lengths[: len(expected)] == expected
    assert set(lengths[len(expected) :]) == {65} and len(lengths) > len(expected) + 200
    line = arrivals.line()
    assert line is not None and line.span_s == pytest.approx(255 * 65 * STRETCH_S, rel=0.2)


def test_of_two_stretches_that_are_joined_the_less_late_arrival_stays() -> None:
    arrivals = LeastLate(1.0)
    for k in range(16):
        device_s = 2.0 * k * STRETCH_S
        arrivals.note(device_s, device_s + 9.0)
        arrivals.note(device_s + STRETCH_S, device_s + STRETCH_S + (0.001 if k % 2 else 0.002))
    line = arrivals.line()
    assert line is not None
    assert line.device_s == pytest.approx(np.mean([(2 * k + 1) * STRETCH_S for k in range(1, 16, 2)]))
    assert line.host_s - line.device_s == pytest.approx(0.001)
