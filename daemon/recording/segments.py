"""A recording in files of bounded size, that goes on in a new one when a disk that was full has room again."""

import shutil
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from daemon.recording.record_link import Entry
from limbcal.errors import DeviceError
from protocol.recording import RecordingWriter
from protocol.recording_files import numbered

#: Memory for messages while nothing can be written; beyond it the oldest ones go, and are counted.
_KEPT_BYTES = 64 * 1024 * 1024
#: How often a disk that failed is tried again, and how often the room on one that works is looked at.
_TRY_S, _LOOK_S = 2.0, 1.0
#: … at last.
_LAST_TRY_S = 60.0


@dataclass(frozen=True)
class Limits:
    """When a file is full, and how much room is left to others.

    Attributes
    ----------
    file_bytes, file_s : float
    free_bytes : float
        Recording pauses when less than this is free.
    """

    file_bytes: float
    file_s: float
    free_bytes: float


class Segments:
    """Writes messages to a file, and to the next one when it is full or the disk has failed.

    What has not safely left for the disk is kept, and written to the next file first.

    Parameters
    ----------
    path : Path
        The first file; the others are numbered from 2.
    texts : (arm_toml, config_toml)
        Attached to each.
    limits : Limits
    on_pause, on_resume : callable
        Called with a sentence when nothing can be recorded any more, and a path when something can again.
    clock : callable
        Seconds that never go back.

    Attributes
    ----------
    messages : int
        Written so far.
    lost : int
        Messages that could be neither written nor kept, or were in a file that somebody took away.
    removed : int
        Files that were taken away while they were written.
    paused, ever_paused : bool

    Raises
    ------
    DeviceError
        If the first file cannot be made.
    """

    def __init__(
        self,
        path: Path,
        texts: tuple[str, str],
        limits: Limits,
        on_pause: Callable[[str], None],
        on_resume: Callable[[str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.messages = 0
        self.lost = 0
        self.removed = 0
        self.paused = False
        self.ever_paused = False
        self._path, self._texts, self._limits, self._clock = path, texts, limits, clock
        self._on_pause, self._on_resume = on_pause, on_resume
        self._number = 1
        self._kept: deque[Entry] = deque()
        self._kept_bytes = 0
        self._began_s = self._look_s = self._try_s = clock()
        self._pause_s = _TRY_S
        self._before = 0  # messages in the files before this one
        self._writer = RecordingWriter(path, *texts, clock=clock)

    def write(self, entries: Sequence[Entry]) -> None:
        """Write messages, or keep them while nothing can be written; do what is due.

        Call it a few times a second also when no message comes.
        """
        for entry in entries:
            self._keep(entry)
            if not self.paused:
                self._attempt(self._put, entry)
        self._poll()

    def _poll(self) -> None:
        """Do what is due."""
        now = self._clock()
        if self.paused:
            if now >= self._try_s + self._pause_s:
                self._try_s = now
                self._resume()
            return
        self._attempt(self._writer.poll)
        if self.paused or now < self._look_s + _LOOK_S:
            return
        self._look_s = now
        if now >= self._began_s + _LAST_TRY_S:  # it has worked for long: the next failure is another one
            self._pause_s = _TRY_S
        if not self._writer.is_there():
            self._begin_anew()
        elif self._room() < self._limits.free_bytes:
            self._attempt(self._finish)
            if not self.paused:
                self._pause(
                    f"recording {self._writer.path}: the disk has less than {_megabytes(self._limits)} left"
                )
        elif now >= self._began_s + self._limits.file_s or self._writer.size_bytes >= self._limits.file_bytes:
            self._attempt(self._next)

    def close(self) -> None:
        """Finish the file; one without a single message is taken away."""
        if self.paused:
            self._resume()
        if not self.paused and not self._writer.is_there():
            self._begin_anew()
        if not self.paused:
            self._attempt(self._writer.close)
        if self.paused:
            self.lost += len(self._kept)
        if self.messages == 0:
            self._writer.path.unlink(missing_ok=True)

    def _put(self, entry: Entry) -> None:
        self._writer.write(entry.topic, entry.payload, entry.t_ns)
        self.messages += 1

    def _keep(self, entry: Entry) -> None:
        self._kept.append(entry)
        self._kept_bytes += len(entry.payload)
        if not self.paused:
            self._forget(self._writer.unsafe + 1)  # and this one, which is not written yet
        while self._kept_bytes > _KEPT_BYTES:
            self._kept_bytes -= len(self._kept.popleft().payload)
            self.lost += 1

    def _forget(self, but: int) -> None:
        """Bound the kept messages: the newest stay."""
        while len(self._kept) > but:
            self._kept_bytes -= len(self._kept.popleft().payload)

    def _attempt(self, action: Callable[..., object], *what: Entry) -> None:
        unsafe = self._writer.unsafe
        try:
            action(*what)
        except DeviceError as error:
            self.messages -= min(unsafe, self._writer.unsafe)
            self._pause(str(error))

    def _pause(self, sentence: str) -> None:
        """Stop writing; what has not safely left is kept for the next file."""
        self.paused = self.ever_paused = True
        self._try_s, self._pause_s = self._clock(), min(2.0 * self._pause_s, _LAST_TRY_S)
        self._on_pause(sentence)

    def _begin_anew(self) -> None:
        """Go on in a new file where somebody took this one away, and count what was in it as lost."""
        gone, unsafe = self._writer.path, self._writer.unsafe
        written = self.messages - self._before
        self.lost += written - min(unsafe, written)  # what is not in the file yet is kept, and written again
        self._forget(unsafe)
        self.messages, self.removed = self._before, self.removed + 1
        self._writer.abandon()
        what = "it" if gone.parent.is_dir() else "its folder"
        self._pause(f"recording {gone}: {what} was taken away while it was written, with what was in it")
        self._resume()

    def _resume(self) -> None:
        if not self._folder_is_there() or self._room() < 2 * self._limits.free_bytes:
            return
        messages = self.messages
        try:
            self._open()
            for entry in self._kept:
                self._put(entry)
        except DeviceError:
            self.messages, self._pause_s = messages, min(2.0 * self._pause_s, _LAST_TRY_S)
            return
        self.paused = False
        self._on_resume(str(self._writer.path))

    def _next(self) -> None:
        self._finish()
        self._open()
        self._on_resume(str(self._writer.path))

    def _finish(self) -> None:
        self._writer.close()
        self._kept.clear()
        self._kept_bytes = 0

    def _open(self) -> None:
        self._number += 1
        path = numbered(self._path, self._number)
        try:
            self._writer = RecordingWriter(path, *self._texts, clock=self._clock)
        except DeviceError:
            path.unlink(missing_ok=True)
            raise
        self._began_s, self._before = self._clock(), self.messages

    def _folder_is_there(self) -> bool:
        """Say whether there is a folder to record into; make it if what it was in is still there.

        Without that it was on a disk that was taken out, and would be made on another one.
        """
        try:
            self._path.parent.mkdir(exist_ok=True)
        except OSError:
            return False
        return True

    def _room(self) -> int:
        try:
            return shutil.disk_usage(self._path.parent).free
        except OSError:
            return 0


def _megabytes(limits: Limits) -> str:
    return f"{limits.free_bytes / 1e6:g} MB"
