"""A device whose frames vary in size: whichever are lost, every sample keeps its number."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from daemon.acquisition.ring import Chunk
from daemon.reception.reception import Reception
from protocol.serial_frame import InfoFrame, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import SCALE, device_info

#: 125 ticks a sample, by INFO.
INFO = device_info(8000.0)
NOW_NS = 10**12


def received(sizes: list[int], lost: set[int], ticks_per_sample: float = 125.0) -> tuple[Reception, int]:
    """Send frames whose samples count themselves; return the reception, and how many have another number."""
    reception = Reception(FrameParser(), InfoFrame(0, 0, INFO))
    runs, sent = [], 0
    for k, n in enumerate(sizes):
        counts = np.tile(np.arange(sent, sent + n, dtype=np.int16)[:, None], (1, 12))
        frame = encode_samples(counts, k + 1, round(sent * ticks_per_sample))
        sent += n
        arrival_ns = NOW_NS + round(1000 * sent * ticks_per_sample)
        runs += reception.take([] if k in lost else [Chunk(arrival_ns, frame)], arrival_ns)
    runs += reception.finish()
    wrong = [np.rint(run.a[:, 0] / SCALE) != run.sample0 + np.arange(len(run.a)) for run in runs]
    return reception, int(np.concatenate(wrong).sum())


def check(sizes: list[int], lost: set[int], ticks_per_sample: float = 125.0) -> None:
    sizes = [min(sizes), max(sizes), *sizes, max(sizes)]  # the bounds are seen first, the last frame comes
    lost = {k for k in lost if k < len(sizes) - 1}
    reception, wrong = received(sizes, lost, ticks_per_sample)
    missing = sum(sizes[k] for k in lost)
    assert (reception.ledger.samples, reception.ledger.lost_samples) == (sum(sizes) - missing, missing)
    assert (wrong, reception.guard.errors, reception.guard.shift) == (0, 0, 0)
    assert "the device's clock jumped" not in reception.ledger.causes


LOST = st.sets(st.integers(2, 61))


@given(sizes=st.lists(st.integers(1, 300), min_size=4, max_size=60), lost=LOST)
@example(sizes=[32, 32, 24, 32, 32, 32, 32], lost={5})  # smaller than the one before
@example(sizes=[24, 40, 8, 24, 24, 24], lost={2, 3})  # before the rate is known
def test_every_sample_keeps_its_number(sizes: list[int], lost: set[int]) -> None:
    check(sizes, lost)


@given(sizes=st.lists(st.integers(24, 40), min_size=4, max_size=60), lost=LOST, off=st.floats(-0.05, 0.05))
def test_every_sample_keeps_its_number_at_another_rate_than_infos(
    sizes: list[int], lost: set[int], off: float
) -> None:
    check(sizes, lost, 125.0 * (1.0 + off))


@pytest.mark.parametrize(("sizes", "exact"), [([32] * 30, True), ([24, 32, 40] * 10, False)])
def test_numbers_tell_how_many_are_missing_only_of_frames_of_one_size(sizes: list[int], exact: bool) -> None:
    reception, wrong = received(sizes, {17})
    assert [(gap.samples, gap.exact) for gap in reception.new_gaps()] == [(sizes[17], exact)]
    assert wrong == 0
