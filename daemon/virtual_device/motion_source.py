"""A process that computes the virtual arm's samples ahead of time, so that streaming never waits for it."""

import signal
from collections import deque
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection

import numpy as np
from numpy.typing import NDArray

from daemon.virtual_device.bench_plan import BenchPlan, Stretch, Truth
from limbcal.errors import DeviceError, LimbcalError
from limbcal.interrupts import interrupts_held

#: Two trials: the next one is computed while these are streamed.
_AHEAD_S = 13.5
#: How long the process may take to be gone after it was ended [s].
_JOIN_S = 5.0


class MotionSource:
    """The samples of a plan from its beginning on, taken in any number.

    Parameters
    ----------
    plan : BenchPlan
    keep_truth : bool
        Whether to keep the true motion of what is taken.
    """

    def __init__(self, plan: BenchPlan, keep_truth: bool) -> None:
        self.taken = 0
        self._plan = plan
        self._keep_truth = keep_truth
        self._ahead: deque[NDArray[np.int16]] = deque()
        self._ahead_samples = 0
        self._truth: list[Truth] = []
        context = get_context("spawn")
        self._receiver, sender = context.Pipe(duplex=False)
        self._process = context.Process(target=_compute, args=(sender, plan), name="limbd-virtual-motion")
        with interrupts_held():
            self._process.start()
        sender.close()

    def wait(self, timeout_s: float) -> bool:
        """Wait until there is something to `fetch`; return whether there is."""
        return self._ahead_samples > 0 or self._receiver.poll(timeout_s)

    def fetch(self) -> None:
        """Take over one more piece where there is one and it is wanted; does not wait.

        Raises
        ------
        LimbcalError
            If the plan cannot be computed.
        """
        if self._ahead_samples > _AHEAD_S * self._plan.rate_hz or not self._receiver.poll():
            return
        try:
            piece: Stretch | LimbcalError = self._receiver.recv()
        except EOFError as error:
            raise DeviceError("the process that computes the virtual arm's motion ended by itself") from error
        if isinstance(piece, LimbcalError):
            raise piece
        self._ahead.append(piece.counts)
        self._ahead_samples += len(piece.counts)
        if self._keep_truth and piece.truth:
            self._truth.append(piece.truth)

    def take(self, n_sample: int) -> NDArray[np.int16] | None:
        """Return the next samples, (n_sample, n_channel), or None where they are not all there yet."""
        if self._ahead_samples < n_sample:
            return None
        rows: list[NDArray[np.int16]] = []
        missing = n_sample
        while missing:
            piece = self._ahead.popleft()
            rows.append(piece[:missing])
            if len(piece) > missing:
                self._ahead.appendleft(piece[missing:])
            missing -= len(rows[-1])
        self._ahead_samples -= n_sample
        self.taken += n_sample
        return rows[0] if len(rows) == 1 else np.concatenate(rows)

    def truth(self) -> Truth:
        """Return the true motion of the samples taken so far, by column."""
        if not self._truth:
            return {}
        joined = {name: np.concatenate([part[name] for part in self._truth]) for name in self._truth[0]}
        taken = joined["t"] < (self.taken - 0.5) / self._plan.rate_hz
        return {name: values[taken] for name, values in joined.items()}

    def close(self) -> None:
        """End the process."""
        self._receiver.close()
        self._process.terminate()
        self._process.join(_JOIN_S)
        self._process.close()


def _compute(sender: Connection, plan: BenchPlan) -> None:
    """Compute in a process of its own, which alone loads the compiler: that takes a second."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a Ctrl-C is the device's to act on
    import_module("daemon.virtual_device.motion_pieces").send_pieces(sender, plan)
