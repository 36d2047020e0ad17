"""A playback in a process of its own, for the page that shows it."""

import argparse
import multiprocessing
import os
import shutil
import signal
import tempfile
import threading
import time
from multiprocessing.connection import Connection, wait
from types import TracebackType

import zmq

from limbcal.errors import ConfigError, DeviceError, LimbcalError
from limbcal.interrupts import interrupts_held
from playback.client import ask
from playback.commands import serve
from playback.control_message import Request

#: How long a playback may take to load what it is to play [s], and to end when it is asked to.
START_S, END_S = 120.0, 5.0


class PlaybackProcess:
    """`limbplay serve` on endpoints of its own, beside the page, so that neither makes the other late.

    Parameters
    ----------
    context : zmq.Context
    arguments : argparse.Namespace
        What `limbplay serve` takes.

    Attributes
    ----------
    endpoint, control : str
        Where it publishes and where it is controlled.

    Raises
    ------
    ConfigError
        If it cannot be played.
    DeviceError
        If the process does not come up.
    """

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", arguments: argparse.Namespace) -> None:
        self._folder = tempfile.mkdtemp(prefix="limbplay-")
        self.endpoint, self.control = f"ipc://{self._folder}/play", f"ipc://{self._folder}/control"
        given = {**vars(arguments), "endpoint": self.endpoint, "control": self.control}
        spawn = multiprocessing.get_context("spawn")
        ours, theirs = spawn.Pipe(duplex=False)
        self._process = spawn.Process(target=_serve, args=(given, theirs), name="limbplay serve")
        try:
            with interrupts_held():
                self._process.start()
            theirs.close()
            self._wait(context, ours)
        except BaseException:
            self.close()
            raise
        finally:
            ours.close()

    def alive(self) -> bool:
        """Say whether it still runs."""
        return self._process.is_alive()

    def close(self) -> None:
        """End the process; harmless when repeated."""
        if self._process.pid is not None:
            self._process.terminate()
            self._process.join(END_S)
            if self._process.is_alive():
                self._process.kill()
                self._process.join()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> "PlaybackProcess":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _wait(self, context: "zmq.Context[zmq.Socket[bytes]]", pipe: Connection) -> None:
        """Wait until it answers, or says why it cannot."""
        until_s = time.monotonic() + START_S
        while time.monotonic() < until_s:
            try:
                if pipe.poll(0):
                    raise pipe.recv()
                ask(context, self.control, Request("state"), 200)
                return
            except EOFError as error:
                self._process.join(END_S)
                raise DeviceError(f"the playback's process ended with code {self._process.exitcode}") from error
            except DeviceError:
                if not self._process.is_alive() and not pipe.poll(0):
                    raise
        raise DeviceError(f"the playback's process does not answer within {START_S:g} s")


def _serve(given: dict[str, object], pipe: Connection) -> None:
    """Serve until ended, and say what keeps it from serving."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the page, which ends this one
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    signal.signal(signal.SIGTERM, _stop)
    try:
        serve.serve(argparse.Namespace(**given))
    except LimbcalError as error:
        pipe.send(_portable(error))
    finally:
        pipe.close()


def _portable(error: LimbcalError) -> LimbcalError:
    return ConfigError(error.mistakes) if isinstance(error, ConfigError) else error


def _stop(_signum: int, _frame: object) -> None:
    raise SystemExit  # and not KeyboardInterrupt, of which `serve` would tell the person at the terminal


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)
