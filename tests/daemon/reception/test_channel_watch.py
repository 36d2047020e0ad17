"""Full scale and stillness are counted, channel by channel."""

import numpy as np
import pytest

from daemon.reception.channel_watch import ChannelWatch
from protocol.device_info import Channel

RATE_HZ = 1000.0


def watch(*channels: Channel) -> ChannelWatch:
    return ChannelWatch(channels, RATE_HZ)


def test_readings_at_either_end_are_counted() -> None:
    seen = watch(Channel("a", 0.01, 0.0, 100.0), Channel("b", 1.0, 0.0, 1e6), Channel("c", -0.01, 0.0, 100.0))
    counts = np.zeros((6, 3), dtype=np.int16)
    counts[:, 0] = [10000, -10000, 9999, -9999, 32767, 0]
    counts[:, 1] = [32767, -32768, 32766, 0, 0, 0]
    counts[:, 2] = [10000, -10000, 9999, 0, 0, 0]
    seen.watch(counts)
    np.testing.assert_array_equal(seen.saturated, [3, 2, 2])


def test_an_offset_moves_the_ends() -> None:
    seen = watch(Channel("a", 1.0, 50.0, 100.0))
    seen.watch(np.array([[50], [-150], [49], [-149]], dtype=np.int16))
    np.testing.assert_array_equal(seen.saturated, [2])


def test_a_channel_that_stands_still_for_long_is_flat() -> None:
    seen = watch(Channel("alive", 1.0, 0.0, 100.0), Channel("dead", 1.0, 0.0, 100.0))
    counts = np.zeros((10, 2), dtype=np.int16)
    for k in range(30):
        counts[:, 0] = k % 2
        counts[:, 1] = 7
        seen.watch(counts)
    np.testing.assert_array_equal(seen.flat, [0, 300 - 100])


def test_a_channel_that_wakes_is_no_longer_flat() -> None:
    seen = watch(Channel("a", 1.0, 0.0, 100.0))
    for k in range(30):
        seen.watch(np.full((10, 1), k >= 20, dtype=np.int16))
    flat = int(seen.flat[0])
    seen.watch(np.array([[0], [1]], dtype=np.int16))
    assert seen.flat[0] == flat


def test_mean_spread_and_noise_are_those_of_the_counts() -> None:
    """Noise by second differences within a block, of which six times the variance is the mean square."""
    rng = np.random.default_rng(3)
    counts = rng.integers(-300, 300, (7, 2)).astype(np.int16)
    seen = watch(Channel("a", 0.5, 10.0, 1e6), Channel("b", -2.0, -3.0, 1e6))
    seen.watch(counts[:4])
    seen.watch(counts[4:5])
    seen.watch(counts[5:])
    reading = seen.take()
    bends = np.diff(counts[:4].astype(float), 2, axis=0)
    assert reading.samples == 7
    np.testing.assert_allclose(reading.mean, [0.5, -2.0] * counts.mean(axis=0) + [10.0, -3.0])
    np.testing.assert_allclose(reading.spread, [0.5, 2.0] * counts.std(axis=0))
    np.testing.assert_allclose(reading.noise, [0.5, 2.0] * np.sqrt(np.sum(bends**2, axis=0) / 12.0))


def test_a_reading_is_of_the_time_since_the_last() -> None:
    seen = watch(Channel("a", 1.0, 0.0, 100.0))
    seen.watch(np.array([[32767], [-32768], [100], [-100], [99], [32766]], dtype=np.int16))
    first = seen.take()
    assert (first.saturated.tolist(), first.clipped.tolist(), first.samples) == ([5], [2], 6)
    seen.watch(np.array([[100], [3], [3]], dtype=np.int16))
    second = seen.take()
    assert (second.saturated.tolist(), second.clipped.tolist(), second.samples) == ([1], [0], 3)
    assert second.mean.tolist() == [106 / 3] and seen.saturated.tolist() == [6]
    nothing = seen.take()
    assert (nothing.samples, nothing.mean.tolist(), nothing.noise.tolist()) == (0, [0.0], [0.0])


def test_a_tenth_of_a_second_at_one_count_is_flat() -> None:
    seen = watch(Channel("a", 1.0, 0.0, 100.0))
    for n, flat in ((1, 0), (98, 0), (1, 0), (1, 1), (5, 6)):  # the first count differs from none before it
        seen.watch(np.full((n, 1), 7, dtype=np.int16))
        assert seen.flat.tolist() == [flat]
    assert seen.take().flat.tolist() == [6] and seen.take().flat.tolist() == [0]


@pytest.mark.parametrize("rate_hz", [0.1, 1.0, 4.9, 50.0])
def test_of_a_slow_device_ten_samples_at_one_count_are_flat(rate_hz: float) -> None:
    seen = ChannelWatch([Channel(name, 1.0, 0.0, 100.0) for name in ("moves", "stands")], rate_hz)
    for k in range(1, 13):
        seen.watch(np.array([[7 * k, 7]], dtype=np.int16))
    assert seen.flat.tolist() == [0, 2]  # the first count differs from none before it
