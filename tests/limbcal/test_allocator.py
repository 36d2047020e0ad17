"""Memory after a burst, in a process of its own: what is used here stays out of it."""

import subprocess
import sys

import pytest

#: What a disk that stalls does to the pipeline: large messages pile up among small ones that stay.
BURST = """
import sys
import psutil
from limbcal.allocator import give_back, large_blocks_apart

def used_mb():
    return psutil.Process().memory_full_info().uss / 1e6

apart, size = sys.argv[1] == "True", int(sys.argv[2])
if apart:
    large_blocks_apart()
for n in range(17, 25):  # each block that is freed has glibc keep larger ones
    b"x" * 2**n
before_mb = used_mb()
kept = []
messages = [(b"x" * size, kept.append(bytes(2000))) for _ in range(60_000_000 // size)]
burst_mb = used_mb()
messages.clear()
freed_mb = used_mb()
give_back()
print(burst_mb - before_mb, freed_mb - before_mb, used_mb() - before_mb)
"""


def burst(apart: bool, size: int) -> list[float]:
    """Return how much more is used at the height of a burst, after it, and once memory was given back [MB]."""
    command = [sys.executable, "-c", BURST, str(apart), str(size)]
    return [float(word) for word in subprocess.check_output(command, text=True).split()]


def test_what_a_burst_took_is_given_back_although_small_things_stay() -> None:
    high_mb, _, after_mb = burst(apart=False, size=40_000)
    assert high_mb > 50.0
    assert after_mb < 10.0


@pytest.mark.parametrize("size", [200_000, 1_000_000])
def test_large_blocks_go_at_once(size: int) -> None:
    high_mb, freed_mb, _ = burst(apart=True, size=size)
    assert high_mb > 50.0
    assert freed_mb < 5.0
