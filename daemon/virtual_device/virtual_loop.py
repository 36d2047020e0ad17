"""`limbd virtual`: the virtual arm on a pseudo-terminal, in real time."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from select import select

import numpy as np

from daemon.process.stop_signal import StopSignal
from daemon.virtual_device.bench_plan import BenchPlan
from daemon.virtual_device.device_time import DeviceTime
from daemon.virtual_device.fault_injection import FaultInjection
from daemon.virtual_device.fault_schedule import Fault
from daemon.virtual_device.faulty_line import FaultyLine
from daemon.virtual_device.motion_source import MotionSource
from daemon.virtual_device.virtual_device import FrameFifo, Timing, VirtualDevice, device_info
from daemon.virtual_device.virtual_port import VirtualPort
from limbcal.command import console, emit
from limbcal.errors import DeviceError
from limbcal.real_time import DEVICE, ask_for_real_time
from protocol.deadline import Ticker

#: Period in which frames that are due are made [s]: long enough to cost little, short enough for a tty to hold
#: them.
_BEAT_S = 0.005
#: How much of the stream the device can hold back for its host [s].
_FIFO_S = 0.5
#: How long one waits at a time for the first samples before one looks whether to stop [s].
_READY_S = 0.1
#: An int16, see docs/protocol.md.
_BYTES_PER_SAMPLE_OF_A_CHANNEL = 2


@dataclass(frozen=True)
class VirtualOptions:
    """What was asked for on the command line.

    ``claimed_hz`` is the rate that INFO says; with ``patient`` the arm waits while the host does not read.
    """

    plan: BenchPlan
    claimed_hz: float
    timing: Timing
    speed: float
    link: Path | None
    truth: Path | None
    as_json: bool
    faults: tuple[Fault, ...] = ()
    patient: bool = False


def serve(options: VirtualOptions) -> None:
    """Be a device until a stop is asked for.

    Raises
    ------
    ConfigError
        If the link cannot be made or the arm cannot be driven.
    DeviceError
        If the truth cannot be written.
    """
    plan = options.plan
    info = device_info(plan.arm, options.claimed_hz, plan.seed)
    stream_bytes_s = plan.rate_hz * options.speed * len(info.channels) * _BYTES_PER_SAMPLE_OF_A_CHANNEL
    fifo = FrameFifo(round(_FIFO_S * stream_bytes_s) + 65536)
    line = FaultyLine(fifo, plan.seed)
    with StopSignal() as stop, VirtualPort(options.link) as port:
        device = VirtualDevice(
            info,
            lambda: MotionSource(plan, options.truth is not None),
            line,
            options.speed,
            time.monotonic(),
            options.timing,
            fifo.is_half_full if options.patient else None,
        )
        injection = FaultInjection(options.faults, info, device, line, port)
        ask_for_real_time(DEVICE)  # it stands for hardware, which nothing else on the host slows down
        try:
            port.unplug()  # that it can be made is known; while kernels are compiled no host shall find it silent
            while not stop.came and not device.ready(_READY_S):
                continue
            port.plug()
            _announce(options, port.path)
            _serve(device, fifo, port, stop, injection)
        finally:
            device.close()
            if fifo.dropped:
                console.print(f"frames dropped, as the host did not read: {fifo.dropped}")
            if line.done:
                hits = ", ".join(f"{count} by {kind}" for kind, count in line.done.items())
                console.print(f"frames hit by faults: {hits}")
            if options.truth is not None:
                _write_truth(options.truth, device)


def _serve(
    device: VirtualDevice, fifo: FrameFifo, port: VirtualPort, stop: StopSignal, injection: FaultInjection
) -> None:
    at = DeviceTime(time.monotonic)
    ticker = Ticker(_BEAT_S, time.monotonic, _attend(device, fifo, port, stop, at))
    said = False
    while not stop.came:
        ticker.wait()
        ticker.skip_missed()
        now_s = at.follow()
        injection.make(now_s)
        device.advance(now_s)
        if not port.plugged:
            fifo.clear()
            continue
        fifo.drain(port.write)
        if fifo.dropped and not said:
            said = True
            console.print("the host does not read: frames are dropped")


def _attend(
    device: VirtualDevice, fifo: FrameFifo, port: VirtualPort, stop: StopSignal, at: DeviceTime
) -> Callable[[float], None]:
    """Return a sleep that meanwhile hears the host and sends it what waits; it may end early."""

    def sleep(seconds: float) -> None:
        waited_for: list[VirtualPort | StopSignal] = [port, stop] if port.plugged else [stop]
        readable, writable, _ = select(waited_for, [port] if port.plugged and len(fifo) else [], [], seconds)
        if port in readable:
            device.receive(port.read(), at.follow())
        if port in readable or port in writable:
            fifo.drain(port.write)

    return sleep


def _announce(options: VirtualOptions, path: str) -> None:
    plan = options.plan
    if not options.as_json:
        emit(path)
        return
    emit(
        json.dumps(
            {
                "port": path,
                "link": None if options.link is None else str(options.link),
                "arm": plan.arm.name,
                "seed": plan.seed,
                "rate_hz": options.claimed_hz,
                "sampled_hz": plan.rate_hz,
                "clock_ppm": 1e6 * (options.timing.clock - 1.0),
                "speed": options.speed,
                "trials": plan.trials,
                "noise": plan.noise,
                "highpass_hz": plan.highpass_hz,
            }
        )
    )


def _write_truth(path: Path, device: VirtualDevice) -> None:
    try:
        with path.open("wb") as file:
            np.savez(file, **device.truth)  # type: ignore[arg-type]
    except OSError as error:
        raise DeviceError(f"--truth {path} cannot be written: {error.strerror}") from error
