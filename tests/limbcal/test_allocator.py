"""Memory after a burst, in a process of its own: what is used here stays out of it."""

import subprocess
import sys

import pytest

#: What a disk that stalls does to the pipeline: large messages pile up among small ones that stay.
BURST = """
import sys
import psutil
from limbcal.allocator import give_back, large_blocks_kept

def used_mb():
    return psutil.Process().memory_full_info().uss / 1e6

size = int(sys.argv[1])
large_blocks_kept()
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


def burst(size: int) -> list[float]:
    """Return how much more is used at the height of a burst, after it, and once memory was given back [MB]."""
    command = [sys.executable, "-c", BURST, str(size)]
    return [float(word) for word in subprocess.check_output(command, text=True).split()]


@pytest.mark.parametrize("size", [40_000, 200_000, 1_000_000])
def test_what_a_burst_took_is_kept_until_it_is_given_back_although_small_things_stay(size: int) -> None:
    high_mb, freed_mb, after_mb = burst(size)
    assert high_mb > 30.0
    assert freed_mb > 0.9 * high_mb
    assert after_mb < 10.0
