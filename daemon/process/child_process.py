"""A process of the daemon, seen from both sides."""

import signal
import traceback
from importlib import import_module
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnContext
from typing import Any

from daemon.process.control_line import ControlLine, Said, SupervisorGone
from limbcal.errors import ConfigError, DataError, DeviceError, LimbcalError
from limbcal.interrupts import interrupts_held

#: What a child may end with besides a `DeviceError`, by the name that crosses the line: a mistake in the config
#: or in the recording that is replayed. Bytes that break a protocol are a fault at run time, exit code 3.
_FAILURES: dict[str, type[LimbcalError]] = {kind.__name__: kind for kind in (ConfigError, DataError)}
#: How long a process that was killed may take to be gone [s]; the kernel takes milliseconds.
_KILLED_JOIN_S = 5.0


class ChildProcess:
    """A started process and the line to it.

    Parameters
    ----------
    context : SpawnContext
    name : str
    work : str
        ``module:function``, called in the process with its end of the line and ``arguments``. It is imported
        there only: the others have no use for, say, a compiler, which takes a second to load.
    """

    def __init__(self, context: SpawnContext, name: str, work: str, *arguments: Any) -> None:
        self.name = name
        ours, theirs = context.Pipe()
        self.line = ControlLine(ours)
        self._process = context.Process(
            target=_be_child, args=(theirs, work, arguments), name=f"limbd-{name}", daemon=False
        )
        with interrupts_held():
            self._process.start()
        theirs.close()  # so that the end of the process is the end of the line

    @property
    def pid(self) -> int:
        """Process number."""
        return self._process.pid or 0

    @property
    def alive(self) -> bool:
        """Whether it runs."""
        return self._process.is_alive()

    def said(self) -> list[Said] | None:
        """Return what it has said; None once it has said its last."""
        heard: list[Said] = []
        try:
            while (said := self.line.hear()) is not None:
                heard.append(said)
        except SupervisorGone:
            return heard or None
        return heard

    def end(self, timeout_s: float) -> bool:
        """Tell it to stop and wait; kill it where it does not. Return whether it ended by itself."""
        self.line.tell("stop")
        self._process.join(timeout_s)
        willing = not self._process.is_alive()
        if not willing:
            self._process.kill()
            self._process.join(_KILLED_JOIN_S)
        return willing

    def close(self) -> None:
        """Give back what the ended process held here."""
        self.line.close()
        self._process.close()

    def ended(self) -> DeviceError:
        """Return the error for one that ended without a word."""
        self._process.join(_KILLED_JOIN_S)  # the line ends a moment before the process does
        code = self._process.exitcode
        how = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return DeviceError(f"the {self.name} process ended with {how}, expected it to go on")


def wait_for_any(children: list[ChildProcess], others: list[Any], timeout_s: float) -> list[Any]:
    """Wait until a child says something or another descriptor is readable; return those."""
    waited: list[Any] = [*(child.line for child in children), *others]
    return list(wait(waited, timeout_s))


def raise_failure(child: ChildProcess, said: Said) -> None:
    """Raise what a child ended with, if it said that."""
    if said["what"] == "failed":
        raise failure(said)
    if said["what"] == "crashed":
        raise crash(child, said)


def failure(said: Said) -> LimbcalError:
    """Return the error that a child ended with."""
    return _FAILURES.get(said["kind"], DeviceError)(said["sentence"])


def crash(child: ChildProcess, said: Said) -> DeviceError:
    """Return the error for a child that raised what nobody foresaw; its traceback is shown with `--debug`."""
    trace: str = said["trace"]
    error = DeviceError(f"the {child.name} process failed: {trace.strip().splitlines()[-1]}")
    error.add_note(trace)
    return error


def _be_child(connection: Connection, work: str, arguments: tuple[Any, ...]) -> None:
    # Ctrl-C and systemd signal the whole group; only the supervisor may act on it, in the right order.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    line = ControlLine(connection)
    try:
        module, _, function = work.partition(":")
        getattr(import_module(module), function)(line, *arguments)
    except LimbcalError as error:
        line.tell("failed", kind=type(error).__name__, sentence=str(error))
    except Exception:  # the supervisor says what happened and stops the others
        line.tell("crashed", trace=traceback.format_exc())
    finally:
        line.close()
