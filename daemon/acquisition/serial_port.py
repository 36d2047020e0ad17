"""Opening the tty: exclusive, raw, at any baud rate."""

import errno
import os

import serial

from limbcal.errors import DeviceError

#: Longest that a command of some bytes may take to write [s]: a line that takes none within it is stuck.
_WRITE_TIMEOUT_S = 1.0


def open_port(port: str, baud: int) -> serial.Serial:
    """Open a serial port that nobody else has; reads return at once with what is there.

    Raises
    ------
    DeviceError
        If it does not exist, is no serial port, may not be opened, or is taken.
    """
    try:
        # exclusive: flock. TIOCEXCL would outlive a killed daemon for as long as anybody has the tty open.
        return serial.Serial(port, baud, timeout=0, write_timeout=_WRITE_TIMEOUT_S, exclusive=True)
    except (serial.SerialException, OSError, ValueError) as error:
        raise DeviceError(_sentence(port, baud, error)) from error


def _sentence(port: str, baud: int, error: Exception) -> str:
    number = getattr(error, "errno", None)
    if number in (errno.EAGAIN, errno.EBUSY):
        return f"port {port} is already taken by another process, expected it to be free"
    if number == errno.ENOENT:
        return f"port {port} does not exist, expected the serial port of the device"
    if number in (errno.EACCES, errno.EPERM):
        return f"port {port} may not be opened by this user, expected membership of the group that owns it"
    if number == errno.EISDIR or (os.path.exists(port) and not _is_tty(port)):
        return f"port {port} is not a serial port, expected the tty of the device"
    return f"port {port} cannot be opened at {baud} baud: {error}"


def _is_tty(port: str) -> bool:
    try:
        handle = os.open(port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError:
        return False
    try:
        return os.isatty(handle)
    finally:
        os.close(handle)
