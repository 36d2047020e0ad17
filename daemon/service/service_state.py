"""What the service manager hears of a run: ready, alive, and in a few words how it goes."""

import os

from daemon.process.control_line import Said
from limbcal.notify import notify

#: A service that waits is ready; the first device that it meets then has kernels to be compiled for it.
_COMPILING_USEC = 180_000_000


class ServiceState:
    """Hears what the processes of a run say and passes on what concerns systemd.

    It feeds the watchdog only when the pipeline is heard, or the reader while there is nothing to be tracked.

    Parameters
    ----------
    port : str
        For the words.
    """

    def __init__(self, port: str) -> None:
        self._port = port
        self._tracking = False

    def hear(self, said: Said) -> None:
        """Take something that a process said."""
        what = said["what"]
        if what == "health" or (what == "trying" and not self._tracking):
            notify(WATCHDOG=1)
        elif what == "streaming":
            notify(READY=1, WATCHDOG=1, STATUS=f"streaming from {self._port}")
        elif what == "waiting":
            notify(READY=1, WATCHDOG=1, STATUS=f"waiting for a device: {said['sentence']}")
            if not self._tracking:
                notify(WATCHDOG_USEC=_COMPILING_USEC)
        elif what == "tracking":
            self._tracking = True
            notify(WATCHDOG_USEC=os.environ.get("WATCHDOG_USEC", _COMPILING_USEC))
        elif what == "disk-failed":
            notify(STATUS=said["sentence"])
