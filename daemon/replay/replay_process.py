"""The replay process of `limbd run --replay`: a recording is a device again, on a real pty."""

import time
from pathlib import Path
from select import select

from daemon.process.control_line import ControlLine, SupervisorGone
from daemon.replay.replayed_device import ReplayedDevice
from daemon.virtual_device.virtual_port import VirtualPort
from protocol.deadline import Ticker

#: Period in which samples that are due are sent [s], as of the virtual device.
_BEAT_S = 0.005
#: After the last byte has left, the tty still has some: it is given this long [s].
_LINGER_S = 0.5


def run_replay(line: ControlLine, path: str, speed: float) -> None:
    """Send a recording's samples as the device did, at its rate or `speed` times as fast.

    The supervisor hears ``ready`` with the port, and ``played`` when all has been read; it says ``stop``.

    Parameters
    ----------
    line : ControlLine
    path : str
        The recording; files that it was continued in follow.
    speed : float

    Raises
    ------
    DataError
        If the recording cannot be replayed.
    """
    with VirtualPort(None) as port:
        device = ReplayedDevice(Path(path), speed)
        line.tell("ready", port=port.path)
        _serve(line, port, device)


def _serve(line: ControlLine, port: VirtualPort, device: ReplayedDevice) -> None:
    def sleep(seconds: float) -> None:
        waited_for: list[VirtualPort | ControlLine] = [port, line]
        readable, writable, _ = select(waited_for, [port] if len(device.out) else [], [], seconds)
        if port in readable:
            device.receive(port.read(), time.monotonic())
        if port in readable or port in writable:
            device.out.drain(port.write)

    ticker, quiet_s = Ticker(_BEAT_S, time.monotonic, sleep), 0.0
    while not _told_to_stop(line):
        ticker.wait()
        ticker.skip_missed()
        device.advance(time.monotonic())
        device.out.drain(port.write)
        quiet_s = quiet_s + _BEAT_S if device.played and not len(device.out) else 0.0
        if _LINGER_S < quiet_s <= _LINGER_S + _BEAT_S:
            line.tell("played")


def _told_to_stop(line: ControlLine) -> bool:
    try:
        said = line.hear()
    except SupervisorGone:
        return True
    return said is not None and said["what"] == "stop"
