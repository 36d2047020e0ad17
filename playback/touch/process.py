"""The haptic loop in a process of its own, as its parent sees it: small JSON documents over a pipe."""

import json
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from arm.model import Arm, Floats
from limbcal.errors import ConfigError, DataError, DeviceError, LimbcalError, ProtocolError
from limbcal.interrupts import interrupts_held
from playback.touch.limit import Coupling
from playback.touch.loop import Setup
from playback.touch.loop_process import be_loop

#: Rates of the loop that can be asked for [Hz]: five times the usual one, and a tenth of it; conventions.
MAX_RATE_HZ = 5000.0
MIN_RATE_HZ = 100.0
_FAILURES: dict[str, type[LimbcalError]] = {
    kind.__name__: kind for kind in (ConfigError, DataError, DeviceError, ProtocolError)
}
#: Compiling takes a minute on a slow machine, once; stopping takes no time.
_START_S, _STOP_S = 900.0, 5.0
#: How long one waits at a time for the process's word [s].
_POLL_S = 0.25

Health = dict[str, Any]


class TouchProcess:
    """A simulated arm to be touched, in a process of its own.

    Parameters
    ----------
    arm : Arm
    q0 : (n_joint,), optional
        Where it rests at first; zero unless given.
    rate_hz : float
    coupling : Coupling
    endpoint, haptic : str
        Where to publish, and where devices speak; ``tcp://127.0.0.1:*`` takes any free port.
    keys : Path, optional
        A folder of keys: only whom it lists is let in.

    Attributes
    ----------
    endpoint, haptic : str
        Where they really are, once started.

    Raises
    ------
    ConfigError
        If the rate is none.
    DataError
        If q0 does not fit.
    """

    def __init__(
        self,
        arm: Arm,
        q0: Floats | None = None,
        rate_hz: float = 1000.0,
        coupling: Coupling | None = None,
        endpoint: str = "tcp://127.0.0.1:*",
        haptic: str = "tcp://127.0.0.1:*",
        keys: Path | None = None,
    ) -> None:
        if not MIN_RATE_HZ <= rate_hz <= MAX_RATE_HZ:
            raise ConfigError(f"rate_hz is {rate_hz:g}, expected {MIN_RATE_HZ:g} to {MAX_RATE_HZ:g}")
        q = np.zeros(arm.n_joint) if q0 is None else np.asarray(q0, dtype=np.float64)
        if q.shape != (arm.n_joint,) or not np.isfinite(q).all():
            raise DataError(f"q0 is {q.tolist()}, expected {arm.n_joint} finite numbers")
        self.endpoint, self.haptic = endpoint, haptic
        self._setup = Setup(arm, tuple(q.tolist()), rate_hz, coupling or Coupling(), endpoint, haptic, keys)
        self._health: Health = {}
        self._asked = False
        self._line: Connection | None = None
        self._process: Any = None

    def start(self) -> None:
        """Start it and wait until it runs.

        Raises
        ------
        LimbcalError
            If it cannot: an endpoint is taken, an effect does not go with the law.
        """
        context = get_context("spawn")
        self._line, theirs = context.Pipe()
        self._process = context.Process(target=be_loop, args=(theirs, self._setup), name="limbplay-touch")
        try:
            with interrupts_held():
                self._process.start()
            theirs.close()
            said = self._next(_START_S)
        except BaseException:
            self.close()
            raise
        self.endpoint, self.haptic, self._health = said["endpoint"], said["haptic"], said["health"]

    @property
    def alive(self) -> bool:
        """Whether it runs."""
        return self._process is not None and bool(self._process.is_alive())

    @property
    def pid(self) -> int | None:
        """Process number."""
        return None if self._process is None else self._process.pid

    def health(self) -> Health:
        """Return what `limb/health` last said of it, and ask for more; does not wait.

        Raises
        ------
        DeviceError
            If it has ended by itself.
        """
        if self._line is not None:
            self._take_in()
            if not self._asked:
                self._tell("health")
        return self._health

    def wait_health(self, timeout_s: float = 5.0) -> Health:
        """Return its health as it is now.

        Raises
        ------
        DeviceError
            If it has ended by itself, or does not answer in time.
        """
        self.health()
        self._health = self._next(timeout_s)["health"]
        self._asked = False
        return self._health

    def close(self) -> Health:
        """End it, if it runs, and return its last health; harmless when repeated."""
        if self._line is None:
            return self._health
        self._tell("stop")
        try:
            while self._process.pid is not None and self._process.is_alive():
                said = self._next(_STOP_S)
                self._health = said.get("health", self._health)
        except LimbcalError:
            pass  # it has said its last
        if self._process.pid is not None:
            self._process.join(_STOP_S)
            if self._process.is_alive():
                self._process.kill()
                self._process.join(_STOP_S)
        self._line.close()
        self._line = None
        return self._health

    def __enter__(self) -> "TouchProcess":
        try:
            self.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _tell(self, what: str) -> None:
        assert self._line is not None
        try:
            self._line.send_bytes(what.encode())
            self._asked = self._asked or what == "health"
        except OSError:
            return  # its end is noticed where it is listened to

    def _take_in(self) -> None:
        assert self._line is not None
        while self._line.poll():
            self._health = self._next(0.0).get("health", self._health)
            self._asked = False

    def _next(self, timeout_s: float) -> dict[str, Any]:
        """Return what it says next."""
        assert self._line is not None
        try:
            waited_s = 0.0
            while not self._line.poll(min(_POLL_S, timeout_s)):
                waited_s += _POLL_S
                if waited_s >= timeout_s:
                    raise DeviceError(f"the haptic loop did not answer within {timeout_s:g} s")
            said: dict[str, Any] = json.loads(self._line.recv_bytes())
        except (EOFError, OSError) as error:
            raise DeviceError("the process of the haptic loop ended by itself, expected it to go on") from error
        if "failed" in said:
            error_of = _FAILURES.get(said["failed"], DeviceError)(said["sentence"])
            if said["trace"]:
                error_of.add_note(said["trace"])
            raise error_of
        return said
