"""A pseudo-terminal that looks like the device's serial port."""

import os
import tty
from pathlib import Path
from types import TracebackType

from limbcal.errors import ConfigError

#: Bytes read at once of what the host sends: a tty's buffer.
_READ_BYTES = 4096


class VirtualPort:
    """Both ends of a pty. The slave is kept open, so that a host that closes it takes nothing with it.

    Parameters
    ----------
    link : Path or None
        Where a symbolic link to the slave is wanted. One that a killed device left is replaced.

    Attributes
    ----------
    path : str
        What the host opens.
    plugged : bool
        Whether there is a pty.

    Raises
    ------
    ConfigError
        If the link cannot be made.
    """

    def __init__(self, link: Path | None) -> None:
        self.path = ""
        self.plugged = False
        self._link = link
        self._master = self._slave = -1
        self.plug()

    def plug(self) -> None:
        """Be there; on a new pty, as a device that was plugged in again is.

        Raises
        ------
        ConfigError
            If the link cannot be made.
        """
        self._master, self._slave = os.openpty()
        self.path = os.ttyname(self._slave)
        self.plugged = True
        try:
            tty.setraw(self._slave)
            os.set_blocking(self._master, False)
            if self._link is not None:
                _make_link(self._link, self.path)
        except BaseException:
            self.unplug()
            raise

    def unplug(self) -> None:
        """Be gone, and the link with it; harmless when repeated."""
        if not self.plugged:
            return
        self.plugged = False
        if self._link is not None and self._link.is_symlink() and os.readlink(self._link) == self.path:
            self._link.unlink()
        os.close(self._master)
        os.close(self._slave)

    def fileno(self) -> int:
        """Return the device's end."""
        return self._master

    def read(self) -> bytes:
        """Return what the host sent."""
        try:
            return os.read(self._master, _READ_BYTES)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> int:
        """Send to the host; return how many bytes found room."""
        try:
            return os.write(self._master, data)
        except BlockingIOError:
            return 0

    def close(self) -> None:
        """Take the port and its link away."""
        self.unplug()

    def __enter__(self) -> "VirtualPort":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _make_link(link: Path, target: str) -> None:
    try:
        if link.is_symlink() and not link.exists():
            link.unlink()
        link.symlink_to(target)
    except FileExistsError as error:
        raise ConfigError(f"--link {link} exists already, expected a path that is free") from error
    except OSError as error:
        raise ConfigError(f"--link {link} cannot be made: {error.strerror}") from error
