"""Files end when they are full, and a disk that fails costs nothing as long as it works again."""

import itertools
import resource
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import daemon.recording.segments as module
from daemon.recording.record_link import Entry
from daemon.recording.segments import Limits, Segments
from limbcal.errors import DeviceError
from protocol.message import TRIAL, encode
from protocol.recording_reader import read_recording

Events = list[tuple[str, str]]


class Clock:
    """Seconds that pass when the test says so."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def entry(number: int, size: int = 1) -> Entry:
    fields = {"trial": number, "t_ns": 5, "state": "x" * size, "role": "learn"}
    return Entry(TRIAL, encode(TRIAL, fields)[1], number)


def segments(folder: Path, events: Events, clock: Clock, limits: Limits) -> Segments:
    return Segments(
        folder / "run.mcap",
        ("", ""),
        limits,
        lambda why: events.append(("pause", why)),
        lambda path: events.append(("resume", path)),
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
    events: Events = []
    clock = Clock()
    some = segments(tmp_path, events, clock, limits)
    for number in range(300):
        clock.now_s += 0.3
        some.write([entry(number)])
    some.close()
    assert numbers(tmp_path) == list(range(300))
    followed = [str(tmp_path / f"run-{k:03d}.mcap") for k in range(2, 2 + len(events))]
    assert events == [("resume", path) for path in followed] and len(events) > 3
    assert sorted(map(str, tmp_path.glob("*.mcap"))) == [*followed, str(tmp_path / "run.mcap")]
    assert (some.messages, some.lost, some.ever_paused) == (300, 0, False)


@pytest.mark.usefixtures("small_files")
def test_what_a_failed_disk_did_not_take_is_in_the_next_file(tmp_path: Path) -> None:
    events: Events = []
    clock = Clock()
    some = segments(tmp_path, events, clock, Limits(10**9, 1e9, 0))
    for number in range(3000):
        clock.now_s += 0.02
        some.write([entry(number, 20 + 37 * number % 91)])
    some.close()
    assert numbers(tmp_path) == list(range(3000))  # neither lost nor twice
    assert [what for what, _ in events][:4] == ["pause", "resume", "pause", "resume"]
    assert some.lost == 0


def test_recording_goes_on_when_there_is_room_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = [10**9]
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, free[0]))
    events: Events = []
    clock = Clock()
    some = segments(tmp_path, events, clock, Limits(10**9, 1e9, 10**6))
    for number in range(600):
        clock.now_s += 0.1
        free[0] = 5 * 10**5 if 200 <= number < 400 else 10**9
        some.write([entry(number)])
    some.close()
    assert numbers(tmp_path) == list(range(600))
    assert [what for what, _ in events] == ["pause", "resume"]
    assert "has less than 1 MB left" in events[0][1]
    assert (some.lost, some.ever_paused) == (0, True)


def test_what_can_not_be_kept_is_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, 5))
    events: Events = []
    clock = Clock()
    some = segments(tmp_path, events, clock, Limits(10**9, 1e9, 10))
    for number in range(100):
        clock.now_s += 1.0
        some.write([entry(number, 10**6)])
    some.close()
    assert some.messages + some.lost == 100
    assert some.lost > 90
    assert numbers(tmp_path) == list(range(some.messages))


def test_while_nothing_can_be_written_the_newest_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = [10**9]
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, free[0]))
    monkeypatch.setattr(module, "_KEPT_BYTES", 100_000)
    events: Events = []
    clock = Clock()
    some = segments(tmp_path, events, clock, Limits(10**9, 1e9, 10**6))
    for number in range(500):
        clock.now_s += 0.1
        free[0] = 0 if number >= 20 else 10**9
        some.write([entry(number, 1000)])
    free[0] = 10**9
    some.close()
    found = numbers(tmp_path)
    kept = 100_000 // len(entry(400, 1000).payload)
    assert found[-kept:] == list(range(500 - kept, 500))
    assert 500 - kept - 1 not in found
    assert (some.messages, some.lost) == (len(found), 500 - len(found))


def _taken_away(folder: Path) -> None:
    next(folder.glob("*.mcap")).unlink()


def _replaced(folder: Path) -> None:
    path = next(folder.glob("*.mcap"))
    path.rename(folder / "elsewhere")
    path.write_bytes(b"another file")
    path.rename(folder / "run.other")


def _with_its_folder(folder: Path) -> None:
    shutil.rmtree(folder)


def _moved_with_its_folder(folder: Path) -> None:
    folder.rename(folder.with_name("moved"))


@pytest.mark.parametrize(
    ("what", "said"),
    [
        (_taken_away, "it was taken away while it was written"),
        (_replaced, "it was taken away while it was written"),
        (_with_its_folder, "its folder was taken away while it was written"),
        (_moved_with_its_folder, "its folder was taken away while it was written"),
    ],
)
def test_a_recording_that_is_taken_away_goes_on_in_a_new_file(
    tmp_path: Path, what: Callable[[Path], None], said: str
) -> None:
    events: Events = []
    clock = Clock()
    folder = tmp_path / "recordings"
    folder.mkdir()
    some = segments(folder, events, clock, Limits(10**9, 1e9, 1))
    for number in range(100):
        clock.now_s += 0.1
        if number == 50:
            what(folder)
        some.write([entry(number)])
    some.close()
    assert [what for what, _ in events] == ["pause", "resume"]
    assert said in events[0][1] and "less than" not in events[0][1]
    found = numbers(folder)
    assert found == list(range(100 - len(found), 100)) and len(found) > 40
    assert (some.removed, some.messages, some.lost) == (1, len(found), 100 - len(found))


def test_a_file_that_is_taken_away_in_the_last_moment_is_noticed(tmp_path: Path) -> None:
    events: Events = []
    some = segments(tmp_path, events, Clock(), Limits(10**9, 1e9, 1))
    some.write([entry(number) for number in range(10)])
    _taken_away(tmp_path)
    some.close()
    assert some.removed == 1 and some.messages + some.lost == 10
    assert len(numbers(tmp_path)) == some.messages


def test_a_removed_disk_s_folder_is_not_made_elsewhere(tmp_path: Path) -> None:
    events: Events = []
    clock = Clock()
    folder = tmp_path / "disk" / "recordings"
    folder.mkdir(parents=True)
    some = segments(folder, events, clock, Limits(10**9, 1e9, 1))
    for number in range(300):
        clock.now_s += 0.1
        if number == 50:
            shutil.rmtree(folder.parent)
        if number == 150:
            assert some.paused and not folder.parent.exists()
            folder.parent.mkdir()
        some.write([entry(number)])
    some.close()
    assert [what for what, _ in events] == ["pause", "resume"]
    found = numbers(folder)
    assert found == list(range(300 - len(found), 300)) and len(found) > 240


def test_a_run_without_a_message_leaves_no_file(tmp_path: Path) -> None:
    some = segments(tmp_path, [], Clock(), Limits(10**9, 1e9, 0))
    some.write([])
    some.close()
    assert list(tmp_path.iterdir()) == []


def test_the_disk_is_looked_at_once_a_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[float] = []
    clock = Clock()

    def disk_usage(_: Path) -> object:
        looks.append(clock.now_s)
        return shutil._ntuple_diskusage(0, 0, 10**9)

    monkeypatch.setattr(shutil, "disk_usage", disk_usage)
    some = segments(tmp_path, [], clock, Limits(10**9, 1e9, 10**6))
    for number in range(40):
        clock.now_s += 0.25
        some.write([entry(number)])
    assert looks == [float(second) for second in range(1, 11)]
    some.close()


def test_a_disk_that_fails_is_tried_ever_more_seldom(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Twice what must be free is needed to go on; and each try that fails for another reason doubles the pause."""
    free, tried = [0], []
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(0, 0, free[0]))
    clock = Clock()
    some = segments(tmp_path, [], clock, Limits(10**9, 1e9, 10**6))

    def failing(*_: object, **__: object) -> None:
        tried.append(clock.now_s)
        raise DeviceError("the disk failed")

    def wait(seconds: float) -> None:
        for _ in range(round(10.0 * seconds)):
            clock.now_s += 0.1
            some.write([])

    for number in range(20):
        clock.now_s += 0.1
        some.write([entry(number)])
    free[0] = 2 * 10**6 - 1
    wait(20.0)
    assert some.paused
    with monkeypatch.context() as patched:
        patched.setattr(module, "RecordingWriter", failing)
        free[0] = 2 * 10**6
        wait(100.0)
    pauses = [after - before for before, after in itertools.pairwise(tried)]
    assert pauses[:2] == pytest.approx([8.0, 16.0], abs=0.3) and pauses == sorted(pauses)
    wait(100.0)
    some.close()
    assert not some.paused and numbers(tmp_path) == list(range(20))
