"""The reader process: bytes from the tty into the ring, and the port opened again when it went away.

It shares its interpreter with nobody, so that no computation makes it late; a tty holds some 20 ms of the
stream and then loses it.
"""

import os
import time
from collections.abc import Iterator
from select import select

import serial

from daemon.acquisition.ring import Mark, Memory, Ring
from daemon.acquisition.serial_port import open_port
from daemon.process.control_line import ControlLine, SupervisorGone
from limbcal.errors import DeviceError
from limbcal.real_time import READER, ask_for_real_time

#: Between a read and the next look [s]: taking what gathered meanwhile is cheaper than waking for each byte.
_GATHER_S = 0.006
#: … and the bytes in that time above which it is shorter: a tty holds little more.
_MUCH_BYTES = 8192
#: How long the reader sleeps at the most where nothing comes [s].
_IDLE_S = 0.25
#: Bytes asked for at once: more than a tty ever has.
_READ_BYTES = 65536
#: A tty hands over at most this many bytes a read: a read this long says that there is more.
_FULL_READ_BYTES = 4095
#: No more at once, so that a device that floods the line cannot keep the reader from hearing a stop.
_TAKEN_BYTES = 64 * _FULL_READ_BYTES
#: After STOP the line is drained until it was quiet for the first time, at the most for the second [s]:
#: conventions.
_QUIET_S = 0.1
_DRAIN_LIMIT_S = 1.0
#: A port that went away is tried after the first time, then after twice as long each time up to the second.
_FIRST_TRY_S, _LAST_TRY_S = 0.05, 1.0
#: … or as soon as its name is there again, which costs next to nothing to see: what the device can hold is little.
_APPEARS_S = 0.05
#: Silence after which a device gets the START command again, as a restarted one needs it; then after the
#: same time, then after twice as long each time up to the second, however long it had no power.
_SILENT_S, _LAST_NUDGE_S = 0.5, 2.0
#: Period with which a port's name is looked up: it may come to mean another device file [s].
_LOOK_S = 0.5


def run_reader(
    line: ControlLine, memory: Memory, port: str, baud: int, wait: bool = False, real_time: bool = False
) -> None:
    """Read until asked to stop, then send STOP and drain the tty.

    A device that a killed daemon left streaming is stopped first: what it held back is of the past. One that goes
    away after it was started is waited for, and started again.

    The supervisor may say ``ask`` (INFO is sent), ``start`` (START is sent) and ``stop``; it hears ``ready``, and
    ``waiting`` with a sentence while there is no device.

    Raises
    ------
    DeviceError
        If the port cannot be opened and is not waited for, or the device goes away before it was started.
    """
    if real_time:
        ask_for_real_time(READER)
    ring = Ring(memory)
    port_keeper = _PortKeeper(line, ring, port, baud, wait)
    try:
        port_keeper.follow()
    finally:
        port_keeper.close()
        ring.close()


class _PortKeeper:
    def __init__(self, line: ControlLine, ring: Ring, port: str, baud: int, wait: bool) -> None:
        self._line, self._ring, self._port, self._baud, self._wait = line, ring, port, baud, wait
        self._tty: serial.Serial | None = None
        #: What has come is read into the same memory for as long as the daemon runs: so it does not grow.
        self._taken = memoryview(bytearray(_TAKEN_BYTES))
        self._known = self._started = self._missing = False
        self._said = ""
        self._try_s, self._pause_s = 0.0, _FIRST_TRY_S
        self._gather_s = _GATHER_S
        self._flows = False
        self._heard_s, self._look_s = 0.0, 0.0
        self._nudge_s = self._pace_s = _SILENT_S

    def follow(self) -> None:
        """Serve the line and the port until asked to stop."""
        while True:
            try:
                if self._tty is None and (time.monotonic() >= self._try_s or self._appeared()):
                    self._open()
                if self._flows:  # asleep until something will be there: so it is woken once a read, not twice
                    time.sleep(self._gather_s)
                waited = [self._line] if self._tty is None else [self._line, self._tty]
                timeout_s = _IDLE_S if self._tty is not None else self._until_next_try_s()
                readable, _, _ = select(waited, [], [], timeout_s)
                if self._line in readable and self._told_to_stop():
                    break
                if self._tty is not None:
                    self._serve(self._tty, self._tty in readable)
            except (OSError, ValueError, serial.SerialException) as error:
                self._lose(error)
        if self._tty is not None:
            try:
                _send_stop(self._tty)
                for data in _until_quiet(self._tty):
                    self._ring.write(data, time.monotonic_ns())
            except (OSError, serial.SerialException):
                return  # it went away in the last moment; what it had sent is in the ring

    def close(self) -> None:
        """Close the port."""
        if self._tty is not None:
            self._tty.close()
            self._tty = None

    def _open(self) -> None:
        try:
            self._tty = open_port(self._port, self._baud)
            if not self._known:
                _silence(self._tty)
        except (DeviceError, OSError, serial.SerialException) as error:
            self.close()
            if not (self._known or self._wait):
                raise error if isinstance(error, DeviceError) else self._gone(error) from error
            self._missing = not os.path.exists(self._port)
            self._pause_s = min(2.0 * self._pause_s, _LAST_TRY_S)
            self._try_s = time.monotonic() + self._pause_s
            self._line.tell("trying")
            if str(error) != self._said:
                self._said = str(error)
                self._line.tell("waiting", sentence=self._said)
            return
        self._note_heard()
        self._pause_s = _FIRST_TRY_S
        if not self._known:
            self._known = True
            self._line.tell("ready")
        if self._started:
            self._ring.write(b"", time.monotonic_ns(), Mark.OPENED)
            self._ask(self._tty, b"START\n")
            self._line.tell("reopened")

    def _appeared(self) -> bool:
        """Say whether a name that was not there is now; who may open it is set later, so trying begins anew."""
        if not (self._missing and os.path.exists(self._port)):
            return False
        self._missing, self._pause_s = False, _FIRST_TRY_S
        return True

    def _until_next_try_s(self) -> float:
        wait_s = max(0.0, self._try_s - time.monotonic())
        return min(wait_s, _APPEARS_S) if self._missing else wait_s

    def _lose(self, error: Exception) -> None:
        self._flows = False
        if not self._started and not self._wait:
            raise self._gone(error) from error
        self.close()
        self._said = f"port {self._port}: the device went away ({error})"
        self._ring.write(self._said.encode(), time.monotonic_ns(), Mark.LOST)
        self._line.tell("waiting", sentence=self._said)
        self._try_s, self._pause_s = time.monotonic() + _FIRST_TRY_S, _FIRST_TRY_S

    def _gone(self, error: Exception) -> DeviceError:
        return DeviceError(f"port {self._port}: the device went away while it was read: {error}")

    def _told_to_stop(self) -> bool:
        try:
            said = self._line.hear()
        except SupervisorGone:
            return True
        what = None if said is None else said["what"]
        if what == "start":
            self._started, self._heard_s = True, time.monotonic()
        if self._tty is not None and what in ("ask", "start"):
            self._ask(self._tty, b"INFO\n" if what == "ask" else b"START\n")
        return what == "stop"

    def _serve(self, tty: serial.Serial, readable: bool) -> None:
        self._flows = readable
        if readable:
            taken = self._take(tty)
            self._gather_s = _GATHER_S if taken < _MUCH_BYTES else _GATHER_S * _MUCH_BYTES / taken
        now_s = time.monotonic()
        if self._started and now_s > self._heard_s + self._nudge_s:
            self._nudge_s += self._pace_s
            self._pace_s = min(2.0 * self._pace_s, _LAST_NUDGE_S)
            self._ask(tty, b"START\n")
        if now_s > self._look_s + _LOOK_S:
            self._look_s = now_s
            if os.stat(self._port).st_rdev != os.fstat(tty.fileno()).st_rdev:
                raise OSError("its name has come to mean another device file")

    def _ask(self, tty: serial.Serial, command: bytes) -> None:
        """Send a command that is answered by INFO; that stands in the ring before the answer can."""
        self._ring.write(b"", time.monotonic_ns(), Mark.ASKED)
        tty.write(command)

    def _take(self, tty: serial.Serial) -> int:
        """Move what has come to the ring; return how many bytes that were."""
        descriptor, taken = tty.fileno(), 0
        try:
            while taken < _TAKEN_BYTES:
                more = os.readv(descriptor, [self._taken[taken:]])
                taken += more
                if more < _FULL_READ_BYTES:
                    break
        finally:  # also what came before the port failed
            if taken:
                self._ring.write(self._taken[:taken], time.monotonic_ns())
        if not taken:
            raise OSError("it is readable, and nothing comes")
        self._note_heard()
        return taken

    def _note_heard(self) -> None:
        self._heard_s = time.monotonic()
        self._nudge_s = self._pace_s = _SILENT_S


def _silence(tty: serial.Serial) -> None:
    _send_stop(tty)
    for _ in _until_quiet(tty):
        pass


def _send_stop(tty: serial.Serial) -> None:
    try:
        tty.write(b"STOP\n")
    except serial.SerialTimeoutException:
        return  # a device that no longer listens is drained all the same


def _until_quiet(tty: serial.Serial) -> Iterator[bytes]:
    limit = time.monotonic() + _DRAIN_LIMIT_S
    while time.monotonic() < limit and select([tty], [], [], _QUIET_S)[0]:
        yield tty.read(_READ_BYTES)
