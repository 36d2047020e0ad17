"""Full scale and stillness are counted, channel by channel."""

import numpy as np

from daemon.channel_watch import ChannelWatch
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
