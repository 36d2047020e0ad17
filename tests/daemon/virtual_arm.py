"""The virtual device in a thread of the tests', which have its compiler loaded: a program needs seconds for it."""

import os
import threading
import time
from argparse import ArgumentParser
from collections import deque
from collections.abc import Iterator
from itertools import count

from daemon.commands import virtual
from daemon.virtual_device.bench_plan import BenchPlan, Stretch, Truth
from daemon.virtual_device.fault_injection import FaultInjection
from daemon.virtual_device.faulty_line import FaultyLine
from daemon.virtual_device.motion_source import MotionSource
from daemon.virtual_device.virtual_device import FrameFifo, VirtualDevice, device_info
from daemon.virtual_device.virtual_loop import _serve, memory_for
from daemon.virtual_device.virtual_motion import stretches
from daemon.virtual_device.virtual_port import VirtualPort
from tests.patience import PATIENCE_S

#: So much of the motion is computed before the device is there [s]; what comes after is while it streams.
_BEFORE_S = 20.0
_LAST: "dict[str, _Motion]" = {}


class _Motion:
    """What a plan's process would send, computed once however often the motion begins anew."""

    def __init__(self, plan: BenchPlan, seconds: float) -> None:
        self._stretches, self._known = stretches(plan), list[Stretch]()
        while sum(len(stretch.counts) for stretch in self._known) < seconds * plan.rate_hz:
            self._known.append(next(self._stretches))

    def from_its_beginning(self) -> Iterator[Stretch]:
        for k in count():
            if k == len(self._known):
                self._known.append(next(self._stretches))
            yield self._known[k]


def _motion(plan: BenchPlan, seconds: float) -> _Motion:
    """Return a plan's motion; several tests have the same, one after the other."""
    key = repr((plan, seconds))
    if key not in _LAST:
        _LAST.clear()
        _LAST[key] = _Motion(plan, seconds)
    return _LAST[key]


class _Receiver:
    """The end of a pipe at which all has come already."""

    def __init__(self, motion: _Motion) -> None:
        self._coming = motion.from_its_beginning()

    def poll(self, _timeout_s: float = 0.0) -> bool:
        return True

    def recv(self) -> Stretch:
        return next(self._coming)


class _Source(MotionSource):
    """The samples of a plan, without a process of their own."""

    def __init__(self, plan: BenchPlan, motion: _Motion, keep_truth: bool) -> None:
        self.taken = self._ahead_samples = 0
        self._plan, self._keep_truth = plan, keep_truth
        self._ahead, self._truth = deque(), []
        self._receiver = _Receiver(motion)  # type: ignore[assignment]

    def close(self) -> None:
        """Leave nothing: there is no process."""


class _Stop:
    """Asks the device to stop as a signal asks the program."""

    def __init__(self) -> None:
        self.came = False
        self._read_end, self._write_end = os.pipe()

    def fileno(self) -> int:
        return self._read_end

    def ask(self) -> None:
        self.came = True
        os.write(self._write_end, b".")

    def close(self) -> None:
        os.close(self._read_end)
        os.close(self._write_end)


class VirtualArm:
    """What `limbd virtual` with the same arguments is to a host.

    Attributes
    ----------
    path : str
        The port when it began.
    truth : dict of str to array
        The true motion of what was sent, as `limbd virtual --truth` writes it.
    hits : Counter of str
        Frames that each kind of fault has hit.
    dropped : int
        Frames that found no room because the host did not read.
    """

    def __init__(self, *arguments: str) -> None:
        parser = ArgumentParser()
        virtual.add_arguments(parser)
        options = virtual.options_of(parser.parse_args([*arguments]), as_json=True)
        plan = options.plan
        motion = _motion(plan, _BEFORE_S * options.speed)
        info = device_info(plan.arm, options.claimed_hz, plan.seed)
        self._fifo = FrameFifo(memory_for(info, options))
        line = FaultyLine(self._fifo, plan.seed)
        self._port, self._stop, self._failed = VirtualPort(options.link), _Stop(), None
        self._device = VirtualDevice(
            info,
            lambda: _Source(plan, motion, keep_truth=True),
            line,
            options.speed,
            time.monotonic(),
            options.timing,
            self._fifo.is_half_full if options.patient else None,
        )
        self._injection = FaultInjection(options.faults, info, self._device, line, self._port)
        self.path, self.hits = self._port.path, line.done
        self._device.ready(0.0)
        self._thread = threading.Thread(target=self._be)
        self._thread.start()

    @property
    def truth(self) -> Truth:
        return self._device.truth

    @property
    def dropped(self) -> int:
        return self._fifo.dropped

    @property
    def alive(self) -> bool:
        return self._thread.is_alive()

    def stop(self) -> None:
        """End it; raise what went wrong in it."""
        if self._stop.came:
            return
        self._stop.ask()
        self._thread.join(PATIENCE_S)
        self._port.close()
        self._stop.close()
        if self._failed is not None:
            raise self._failed

    def _be(self) -> None:
        try:
            _serve(self._device, self._fifo, self._port, self._stop, self._injection)  # type: ignore[arg-type]
        except BaseException as error:  # noqa: BLE001 - raised again where it is seen
            self._failed = error
