"""A host clock that is set tears nothing, and is noticed."""

from hypothesis import given
from hypothesis import strategies as st

from daemon.host_clock import HostClock

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
