"""What `limbd run` says while it runs: a line at the start, a status on a terminal, a line at the end."""

from collections.abc import Mapping
from types import TracebackType
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.status import Status

from limbcal.escaped import escaped

_WRONG = (
    "the readings contradict the tracker: check the lengths and the sensors' places in the arm file, and whether "
    "a sensor came loose; `fitter sensors` finds from a recording where each sits and what it reads"
)


class Progress:
    """Words for the person at the terminal, all on stderr."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._status: Status | None = None
        self._last: Mapping[str, Any] | None = None
        self._said_wrong = False

    def __enter__(self) -> "Progress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.stop()
        if self._last is not None:
            self._console.print(escape(_sentence(self._last)), soft_wrap=True)

    def started(self, announced: Mapping[str, Any]) -> None:
        """Say what began."""
        recording = announced["recording"]
        where = "recording nothing" if recording is None else f"recording to {recording}"
        self._console.print(
            _text(
                f"{announced['device']} on {announced['port']} at {announced['rate_hz']:g} Hz, "
                f"arm {announced['arm']}; publishing on {announced['endpoint']}; {where}"
            ),
            soft_wrap=True,
        )
        if self._console.is_terminal:
            self._status = self._console.status("streaming", refresh_per_second=2)
            self._status.start()

    def health(self, fields: Mapping[str, Any]) -> None:
        """Show how it goes; say once if the tracker finds that it is wrong."""
        self._last = fields
        if fields["tracking"]["wrong"] and not self._said_wrong:
            self._said_wrong = True
            self.trouble(_WRONG)
        if self._status is not None:
            self._status.update(escape(_sentence(fields)))

    def trouble(self, sentence: str) -> None:
        """Say what went wrong without ending the run."""
        self._console.print(f"[yellow]warning:[/yellow] {_text(sentence)}", soft_wrap=True)


def _text(sentence: str) -> str:
    return escape(escaped(sentence))


def _sentence(fields: Mapping[str, Any]) -> str:
    p99 = fields["latency_ms"]["p99"]
    latency = "" if p99 is None else f", latency p99 {p99:.1f} ms"
    unrecorded = fields["recording_lost"]
    recorded = f", {unrecorded} messages not recorded" if unrecorded else ""
    rate = "" if fields["rate_hz"] is None else f" at {fields['rate_hz']:.7g} Hz"
    return (
        f"{fields['uptime_s']:.0f} s: {fields['samples']} samples{rate}, {fields['lost_samples']} lost, "
        f"{fields['crc_errors']} checksum errors{latency}{recorded}"
    )
