"""Files end when they are full, and a disk that fails costs nothing as long as it works again."""

import resource
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from daemon.record_link import Entry
from daemon.segments import Limits, Segments
from protocol.message import TRIAL, encode
from protocol.recording_reader import read_recording

Told = list[tuple[str, str]]


class Clock:
    """Seconds that pass when they are told to."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def entry(number: int, size: int = 1) -> Entry:
    fields = {"trial": number, "t_ns": 5, "state": "x" * size, "role": "learn"}
    return Entry(TRIAL, encode(TRIAL, fields)[1], number)


def segments(folder: Path, told: Told, clock: Clock, limits: Limits) -> Segments:
    return Segments(
        folder / "run.mcap",
        ("", ""),
        limits,
        lambda why: told.append(("pause", why)),
        lambda path: told.append(("resume", path)),
        clock,
    )


def numbers(folder: Path) -> list[int]:
    found = []
    for path in sorted(folder.glob("*.mcap"), key=lambda path: (len(path.stem), path.stem)):
        found += [fields["trial"] for _, fields, _ in read_recording(path)]
    return found


@pytest.fixture
def small_files() -> Iterator[None]:
    """Let no file of this process grow beyond 40 kB, as on a disk that is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("limits", [Limits(6_000, 1e9, 0), Limits(10**9, 10.0, 0)])
def test_a_full_file_is_followed_by_another(tmp_path: Path, limits: Limits) -> None:
    told: Told = []
    clock = Clock()
    some = segments(tmp_path, told, clock, limits)
    for number in range(300):
        clock.now_s += 0.3
        some.write([entry(number)])
    some.close()
    assert numbers(tmp_path) == list(range(300))
    assert len(list(tmp_path.glob("*.mcap"))) == 1 + len(told) > 3
    assert {what for what, _ in told} == {"resume"}
    assert (some.messages, some.lost, some.ever_paused) == (300, 0, False)


@pytest.mark.usefixtures("small_files")
def test_what_a_failed_disk_did_not_take_is_in_the_next_file(tmp_path: Path) -> None:
    told: Told = []
    clock = Clock()
    some = segments(tmp_path, told, clock, Limits(10**9, 1e9, 0))
    for number in range(3000):
        clock.now_s += 0.02
        some.write([entry(number, 20 + 37 * number % 91)])
    some.close()
    assert sorted(set(numbers(tmp_path))) == list(range(3000))
    assert [what for what, _ in told][:4] == ["pause", "resume", "pause", "resume"]
    assert some.lost == 0


def test_recording_goes_on_when_there_is_room_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = [10**9]
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, free[0]))
    told: Told = []
    clock = Clock()
    some = segments(tmp_path, told, clock, Limits(10**9, 1e9, 10**6))
    for number in range(600):
        clock.now_s += 0.1
        free[0] = 5 * 10**5 if 200 <= number < 400 else 10**9
        some.write([entry(number)])
    some.close()
    assert numbers(tmp_path) == list(range(600))
    assert [what for what, _ in told] == ["pause", "resume"]
    assert "has less than 1 MB left" in told[0][1]
    assert (some.lost, some.ever_paused) == (0, True)


def test_what_can_not_be_kept_is_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, 5))
    told: Told = []
    clock = Clock()
    some = segments(tmp_path, told, clock, Limits(10**9, 1e9, 10))
    for number in range(100):
        clock.now_s += 1.0
        some.write([entry(number, 10**6)])
    some.close()
    assert some.messages + some.lost == 100
    assert some.lost > 90
    assert numbers(tmp_path) == list(range(some.messages))
