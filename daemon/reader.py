"""The reader process: bytes from the tty into the ring as they arrive, and nothing else.

It shares its interpreter with nobody, so that no computation makes it late; a tty holds some 20 ms of the
stream and then loses it.
"""

import time
from collections.abc import Iterator
from select import select

import serial

from daemon.control_line import ControlLine, SupervisorGone
from daemon.ring import Memory, Ring
from daemon.serial_port import open_port
from limbcal.errors import DeviceError

#: Between the first byte and the read: taking what gathered meanwhile is cheaper than waking for each byte.
_GATHER_S = 0.003
_IDLE_S = 0.25
_READ_BYTES = 65536
#: A tty hands over at most so many bytes a read: a read this long says that there is more.
_FULL_READ_BYTES = 4095
#: So that a device that floods the line cannot keep the reader from hearing a stop.
_READS_AT_ONCE = 64
#: After STOP the line is drained until it was quiet for so long, and no longer than the limit.
_QUIET_S = 0.1
_DRAIN_LIMIT_S = 1.0


def run_reader(line: ControlLine, memory: Memory, port: str, baud: int) -> None:
    """Read until told to stop, then send STOP and drain the tty.

    A device that a killed daemon left streaming is stopped first: what it held back is of the past.

    The supervisor may say ``ask`` (INFO is sent), ``start`` (START is sent) and ``stop``.

    Raises
    ------
    DeviceError
        If the port cannot be opened or the device goes away.
    """
    ring = Ring(memory)
    try:
        with open_port(port, baud) as tty:
            try:
                _silence(tty)
                line.tell("ready")
                _follow(line, tty, ring)
            except (OSError, serial.SerialException) as error:
                raise DeviceError(f"port {port}: the device went away while it was read: {error}") from error
    finally:
        ring.close()


def _follow(line: ControlLine, tty: serial.Serial, ring: Ring) -> None:
    while True:
        readable, _, _ = select([tty, line], [], [], _IDLE_S)
        if line in readable:
            try:
                said = line.hear()
            except SupervisorGone:
                break
            what = None if said is None else said["what"]
            if what == "stop":
                break
            if what == "ask":
                tty.write(b"INFO\n")
            elif what == "start":
                tty.write(b"START\n")
        if tty in readable:
            time.sleep(_GATHER_S)
            _take(tty, ring)
    _send_stop(tty)
    for data in _until_quiet(tty):
        ring.write(data, time.monotonic_ns())


def _take(tty: serial.Serial, ring: Ring) -> None:
    for _ in range(_READS_AT_ONCE):
        data: bytes = tty.read(_READ_BYTES)
        if data:
            ring.write(data, time.monotonic_ns())
        if len(data) < _FULL_READ_BYTES:
            return


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
