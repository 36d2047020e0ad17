"""What the supervisor and a child say to each other: small JSON documents over a pipe of their own."""

import json
import math
import select
from multiprocessing.connection import Connection
from typing import Any

Said = dict[str, Any]


class SupervisorGone(Exception):  # noqa: N818 - says what happened
    """The other end of the line is closed: whoever started this process is no more."""


class ControlLine:
    """One end of the line.

    A child that reads the end of the pipe knows that its supervisor died, however it died, and stops: so no
    process is left behind even after SIGKILL.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._readable = select.poll()  # kept: making one anew for each look costs more than the look
        self._readable.register(connection.fileno(), select.POLLIN)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._connection.fileno()

    def tell(self, what: str, **fields: object) -> None:
        """Say something; a listener that is gone is not an error, its end is noticed elsewhere."""
        try:
            self._connection.send_bytes(json.dumps({"what": what, **fields}).encode())
        except (BrokenPipeError, ConnectionResetError):
            return

    def hear(self, timeout_s: float = 0.0) -> Said | None:
        """Return what was said next, or None where nothing was within the time.

        Raises
        ------
        SupervisorGone
            If the other end is closed.
        """
        try:
            if not self._readable.poll(math.ceil(1000 * timeout_s)):
                return None
            said: Said = json.loads(self._connection.recv_bytes())
        except (EOFError, ConnectionResetError) as error:
            raise SupervisorGone from error
        return said

    def close(self) -> None:
        """Close this end."""
        self._connection.close()
