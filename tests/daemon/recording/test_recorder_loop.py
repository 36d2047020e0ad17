"""How long the recorder listens after a stop, by an inlet and a line of the test's."""

from typing import Any

import pytest

from daemon.process.control_line import SupervisorGone
from daemon.recording import recorder as module
from daemon.recording.record_link import Entry

ENTRY = Entry("limb/gap", b"x", 5)


class Stage:
    """Inlet, line and segments in one; each look takes a quarter of a second."""

    def __init__(self, said: dict[int, Any], entries: dict[int, int], ends: int | None = None) -> None:
        self.said, self.entries, self.ends = said, entries, ends
        self.looks = self.heard = self.given_back = 0
        self.linked = self.ended = False
        self.reported: list[tuple[int, str]] = []
        self.written: list[int] = []

    def receive(self, timeout_s: float) -> list[Entry]:
        assert timeout_s == 0.25
        self.looks += 1
        self.linked = self.linked or self.looks >= 3
        self.ended = self.looks == self.ends
        return [ENTRY] * self.entries.get(self.looks, 0)

    def hear(self) -> Any:
        self.heard += 1
        said = self.said.get(self.heard)
        if isinstance(said, Exception):
            raise said
        return said

    def tell(self, what: str) -> None:
        self.reported.append((self.looks, what))

    def write(self, entries: list[Entry]) -> None:
        self.written.append(len(entries))

    def follow(self, monkeypatch: pytest.MonkeyPatch) -> "Stage":
        monkeypatch.setattr(module.time, "monotonic", lambda: 100.0 + 0.25 * self.looks)
        monkeypatch.setattr(module, "give_back", self._give_back)
        module._follow(self, self, self)  # type: ignore[arg-type]
        return self

    def _give_back(self) -> None:
        self.given_back += 1


def test_the_pipeline_s_goodbye_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    stage = Stage({}, {3: 2, 50: 1}, ends=60).follow(monkeypatch)
    assert stage.looks == 60 and sum(stage.written) == 3 and len(stage.written) == 60
    assert stage.reported == [(3, "linked")]
    assert stage.given_back == 1  # it costs to have it mapped again


@pytest.mark.parametrize(("said", "quiet"), [({"what": "stop"}, 4), (SupervisorGone(), 40)])
def test_after_a_stop_it_listens_until_it_was_quiet(
    monkeypatch: pytest.MonkeyPatch, said: Any, quiet: int
) -> None:
    """A second where the supervisor says so; ten where it is gone, for the pipeline may still be busy."""
    stage = Stage({1: {"what": "other"}, 5: said}, {8: 1, 12: 3}).follow(monkeypatch)
    assert stage.heard == 5 and sum(stage.written) == 4
    assert stage.looks - 12 == quiet


def test_while_nobody_stops_it_quiet_is_no_end(monkeypatch: pytest.MonkeyPatch) -> None:
    stage = Stage({}, {}, ends=500).follow(monkeypatch)
    assert stage.looks == 500 and stage.heard == 500
