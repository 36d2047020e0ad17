"""What a library takes is bounded, and only within."""

import resource

import numpy as np
import pytest

from limbcal.memory_limit import memory_limit


def test_more_than_the_bound_cannot_be_had():
    with pytest.raises(MemoryError), memory_limit(2**28):
        np.empty(2**30, dtype=np.uint8)


def test_up_to_the_bound_it_can_and_afterwards_all_is_as_before():
    before = resource.getrlimit(resource.RLIMIT_AS)
    with memory_limit(2**30):
        assert np.empty(2**28, dtype=np.uint8).size == 2**28
    assert resource.getrlimit(resource.RLIMIT_AS) == before
