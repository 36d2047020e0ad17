"""Gaps of a recording, as a replay asks for them."""

from pathlib import Path

from daemon.pipeline.recorded_gaps import RecordedGaps
from daemon.reception.sample_ledger import Gap
from daemon.recording.recorded_run import TICKS_PER_SAMPLE
from protocol.message import GAP, encode
from protocol.recording import RecordingWriter


def gap(sample0: int, samples: int, why: str = "unplugged") -> Gap:
    return Gap(sample0, samples, 10**9 + sample0, why, exact=True)


def recorded(path: Path, *gaps: Gap) -> Path:
    with RecordingWriter(path, "", "") as writer:
        for one in gaps:
            writer.write(GAP, encode(GAP, vars(one))[1], one.t_ns)
    return path


def before(gaps: RecordedGaps, sample: int) -> Gap | None:
    return gaps.before(TICKS_PER_SAMPLE * sample)


def test_each_gap_is_found_where_it_ends(tmp_path: Path) -> None:
    first, second, third = gap(0, 64), gap(100, 7), gap(500, 32)
    path = recorded(tmp_path / "run.mcap", first, gap(90, 0, "the host's clock was set"), second)
    recorded(tmp_path / "run-002.mcap", second, third)
    gaps = RecordedGaps(path)
    assert [before(gaps, sample) for sample in (64, 107, 300, 532, 600)] == [first, second, None, third, None]


def test_before_the_first_sample_of_all_nothing_is_missing(tmp_path: Path) -> None:
    assert before(RecordedGaps(tmp_path / "not-asked.mcap"), 0) is None
