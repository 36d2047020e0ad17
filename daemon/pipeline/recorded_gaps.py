"""What was missing in a recorded run, and why: of a replay it is known, whose device has no line to lose it on."""

from collections.abc import Iterator
from pathlib import Path

from daemon.reception.sample_ledger import Gap
from daemon.recording.recorded_run import TICKS_PER_SAMPLE, files_from
from protocol.message import GAP
from protocol.recording_reader import read_recording


class RecordedGaps:
    """The gaps of a recording, asked for in their order.

    Parameters
    ----------
    path : Path
        The recording, and what it was continued in; read as far as it is asked about.
    """

    def __init__(self, path: Path) -> None:
        self._gaps = _gaps_of(path)
        self._next: Gap | None = None
        self._read = False

    def before(self, ticks: int) -> Gap | None:
        """Return the gap that ends right before the sample at a tick; None where none was recorded.

        Raises
        ------
        DataError
            If a file cannot be read.
        """
        sample = ticks // TICKS_PER_SAMPLE
        if not sample:
            return None
        if not self._read:
            self._next, self._read = next(self._gaps, None), True
        while self._next is not None and self._next.sample0 + self._next.samples < sample:
            self._next = next(self._gaps, None)
        ends_here = self._next is not None and self._next.sample0 + self._next.samples == sample
        return self._next if ends_here else None


def _gaps_of(path: Path) -> Iterator[Gap]:
    """Yield where samples are missing; what was said with none missing, such as of a clock, is left out."""
    for file in files_from(path):
        with read_recording(file, [GAP]) as messages:
            for _, fields, _ in messages:
                if fields["samples"]:
                    yield Gap(*(fields[name] for name in ("sample0", "samples", "t_ns", "why", "exact")))
