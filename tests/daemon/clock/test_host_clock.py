"""A host clock that is set tears nothing, and is noticed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.host_clock import HostClock, Jump

UTC_NS = 1_700_000_000_000_000_000


class Clocks:
    """Two clocks in step, until one is set."""

    def __init__(self) -> None:
        self.now_ns = 5_000
        self.set_ns = UTC_NS

    def utc_ns(self) -> int:
        self.now_ns += 100
        return self.now_ns + self.set_ns

    def monotonic_ns(self) -> int:
        self.now_ns += 100
        return self.now_ns


@given(st.lists(st.sampled_from([-3_600 * 10**9, 3_600 * 10**9, 10**9]), max_size=5))
def test_every_jump_is_noted_and_the_run_goes_on(jumps: list[int]) -> None:
    clocks = Clocks()
    host = HostClock(clocks.utc_ns, clocks.monotonic_ns)
    offset_ns = host.offset_ns
    assert abs(offset_ns - UTC_NS) < 1000
    for by_ns in jumps:
        clocks.set_ns += by_ns
        jump = host.look()
        assert jump is not None and abs(jump.by_ns - by_ns) < 1000
        assert host.look() is None
    assert host.offset_ns == offset_ns
    assert abs(host.ahead_ns - sum(jumps)) < 1000 and host.jumps == len(jumps)


def test_a_clock_that_is_only_slewed_did_not_jump() -> None:
    clocks = Clocks()
    host = HostClock(clocks.utc_ns, clocks.monotonic_ns)
    for _ in range(100):
        clocks.set_ns += 500_000
        assert host.look() is None


@pytest.mark.parametrize(
    ("by_ns", "jumped"), [(49_999_999, False), (50_000_000, True), (-49_999_999, False), (-50_000_000, True)]
)
def test_fifty_milliseconds_at_once_are_a_jump(by_ns: int, jumped: bool) -> None:
    set_ns, now_ns = [UTC_NS], 7_000
    host = HostClock(lambda: now_ns + set_ns[0], lambda: now_ns)
    set_ns[0] += by_ns
    assert host.look() == (Jump(now_ns + UTC_NS, by_ns) if jumped else None)
    assert (host.jumps, host.ahead_ns, host.offset_ns) == (jumped, by_ns, UTC_NS)


def test_of_three_readings_the_quickest_counts() -> None:
    """A pause in between makes the difference of the clocks uncertain by half of it."""
    monotonic = iter([0, 1000, 2000, 2010, 3000, 9000])
    utc = iter([100 + UTC_NS, 2004 + UTC_NS, 3100 + UTC_NS])
    host = HostClock(lambda: next(utc), lambda: next(monotonic))
    assert host.offset_ns == UTC_NS - 1  # 2004, between 2000 and 2010
    assert next(monotonic, None) is None and next(utc, None) is None
