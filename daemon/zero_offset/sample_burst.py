"""Some seconds of samples for this process itself, from the same reader and the same handshake as the daemon's."""

import time
from multiprocessing import get_context

import numpy as np

from arm.model import Arm, Floats
from daemon.acquisition.handshake import Handshake, check_channels
from daemon.acquisition.ring import Mark, Ring, ring_memory
from daemon.process.child_process import ChildProcess, raise_failure, wait_for_any
from daemon.reception.reception import Reception
from limbcal.errors import ConfigError, DeviceError
from protocol.serial_frame import InfoFrame
from protocol.serial_parser import FrameParser

#: 10 s of twelve channels at 32 kHz.
_RING_BYTES = 8 * 1024 * 1024
#: How often the ring is looked into, and the device asked what it is [s].
_LOOK_S = 0.01
_ASK_S = 1.0
#: Silence after START from which on a device is held to send nothing at all.
_SILENCE_S = 5.0
#: Fewer do not tell their noise, which is that of third differences (`tracking/model/noise.py`).
_LEAST_SAMPLES = 4
#: How long the reader may take to end [s], as in `limbd run`.
_PATIENCE_S = 5.0


def sample_burst(port: str, baud: int, arm: Arm, seconds: float) -> tuple[float, Floats]:
    """Start the device, take its samples for a time, and stop it.

    Parameters
    ----------
    port : str
    baud : int
    arm : Arm
        Whose sensors the device's channels must be.
    seconds : float
        By the device's rate.

    Returns
    -------
    rate_hz : float
    a : (n_sample, 3 * n_sensor) [m/s^2]
        Lost samples are not in it.

    Raises
    ------
    ConfigError
        If the device is so slow that these are too few samples.
    DeviceError
        If the port cannot be opened, the device says or sends nothing of sense or goes away, or its channels are
        not the arm's sensors.
    """
    context = get_context("spawn")
    memory = ring_memory(context, _RING_BYTES)
    reader = ChildProcess(context, "reader", "daemon.acquisition.reader:run_reader", memory, port, baud)
    try:
        while "ready" not in _heard(reader, _ASK_S):
            pass
        ring, parser = Ring(memory), FrameParser()
        introduction = _introduction(reader, ring, Handshake(parser, port))
        check_channels(introduction.info, arm, port)
        rate_hz, reception = introduction.info.rate_hz, Reception(parser, introduction)
        wanted = _wanted(seconds, rate_hz)
        reader.line.tell("start")
        return rate_hz, _gathered(reader, ring, reception, wanted, port)
    finally:
        reader.end(_PATIENCE_S)
        reader.close()


def _wanted(seconds: float, rate_hz: float) -> int:
    wanted = round(seconds * rate_hz)
    if wanted < _LEAST_SAMPLES:
        raise ConfigError(
            f"--seconds is {seconds:g}, at the device's {rate_hz:g} Hz {wanted} samples; "
            f"expected {_LEAST_SAMPLES} or more, --seconds {_LEAST_SAMPLES / rate_hz:g}"
        )
    return wanted


def _introduction(reader: ChildProcess, ring: Ring, handshake: Handshake) -> InfoFrame:
    asked_s = -np.inf
    while True:
        if time.monotonic() >= asked_s + _ASK_S:
            reader.line.tell("ask")
            asked_s = time.monotonic()
        _heard(reader, _LOOK_S)
        introduction = handshake.hear(ring.read())
        if introduction is not None:
            return introduction


def _gathered(reader: ChildProcess, ring: Ring, reception: Reception, wanted: int, port: str) -> Floats:
    pieces: list[Floats] = []
    last_s = time.monotonic()
    while reception.ledger.samples < wanted:
        _heard(reader, _LOOK_S)
        chunks = ring.read()
        gone = next((chunk.data.decode() for chunk in chunks if chunk.mark is Mark.LOST), None)
        if gone is not None:
            raise DeviceError(gone)
        runs = reception.take(chunks) if chunks else []
        pieces += [run.a for run in runs]
        if runs:
            last_s = time.monotonic()
        elif time.monotonic() > last_s + _SILENCE_S:
            found = reception.ledger.samples
            raise DeviceError(
                f"port {port}: {found} samples came and then none for {_SILENCE_S:g} s, expected {wanted}"
            )
    return np.concatenate(pieces)[:wanted]


def _heard(reader: ChildProcess, timeout_s: float) -> list[str]:
    """Wait for what the reader says; raise if that is its end."""
    wait_for_any([reader], [], timeout_s)
    said = reader.said()
    if said is None:
        raise reader.ended()
    for item in said:
        raise_failure(reader, item)
    return [item["what"] for item in said]
