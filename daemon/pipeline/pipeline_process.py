"""The pipeline process: knows the device first, then empties the ring until the reader has closed it."""

import time
from contextlib import ExitStack
from pathlib import Path

import zmq

from daemon.acquisition.handshake import Handshake, check_channels
from daemon.acquisition.ring import Memory, Ring
from daemon.config.config import WAIT_ADVICE, Setup
from daemon.pipeline.looks import Looks
from daemon.pipeline.pipeline import Pipeline, tracker_for
from daemon.pipeline.recorded_gaps import RecordedGaps
from daemon.process.control_line import ControlLine, SupervisorGone
from daemon.process.early_stop import stopped_early
from daemon.reception.reception import Reception
from daemon.recording.record_link import Context, RecordLink
from daemon.recording.recorded_run import RecordedClock
from limbcal.allocator import give_back, large_blocks_kept
from limbcal.command import console
from limbcal.errors import ConfigError, DeviceError
from limbcal.real_time import PIPELINE, ask_for_real_time
from protocol.curve import gate_of
from protocol.publisher import Publisher
from protocol.serial_frame import InfoFrame
from protocol.serial_parser import FrameParser

#: How long the ring may gather between two looks into it [s]: a block's length.
_LOOK_S = 0.010
#: Period of `limb/health` [s], see docs/protocol.md.
_HEALTH_S = 1.0
#: Any device that samples so fast [Hz] can be tracked, or none can.
_ANY_RATE_HZ = 8000.0
#: A device that has come back is asked this often what it is [s].
_ASK_S = 1.0
#: After a stop the reader closes the ring; one that was killed never does, and is given up after this [s].
_ABANDONED_S = 5.0


def run_pipeline(
    line: ControlLine, memory: Memory, setup: Setup, run: str, recorder: str | None, recording: str
) -> None:
    """Track what the ring brings until it is closed and empty.

    The supervisor hears ``ready`` with the endpoint, ``heard`` once the device sent its INFO, ``tracking``
    once samples may come, and ``health`` once a second. It says ``handshake`` and ``stop``.

    Parameters
    ----------
    line : ControlLine
    memory : Memory
        The ring that the reader fills.
    setup : Setup
    run : str
        UUID of this run.
    recorder : str or None
        Endpoint of the recorder; None where nothing is recorded.
    recording : str
        Path of what it records to.

    Raises
    ------
    LimbcalError
        If the endpoint is taken, or the device sends nothing of sense or does not fit the arm.
    """
    large_blocks_kept()
    with ExitStack() as stack:
        context: Context = zmq.Context()
        stack.callback(context.term)
        publish = setup.config.publish
        gate = stack.enter_context(gate_of(context, None if publish.keys is None else Path(publish.keys)))
        publisher = Publisher(context, publish.endpoint, setup.arm.name, run, gate)
        stack.callback(publisher.close)
        link = None
        if recorder is not None:
            link = RecordLink(context, recorder, recording)
            stack.callback(link.close)
        ring, parser = Ring(memory), FrameParser()
        line.tell("ready", endpoint=publisher.endpoint)
        introduction = _introduction(line, ring, parser, setup, publisher)
        if introduction is None:
            return
        stack.callback(console.show_cursor)  # a compiler that is left hides it
        with stopped_early(line, stack.close):  # where kernels are compiled, it takes minutes
            reception = _reception(setup, parser, introduction)
            pipeline = _pipeline(setup, run, reception, publisher, link)
        if setup.config.device.real_time:  # not before its kernels are compiled
            ask_for_real_time(PIPELINE)
        line.tell("tracking", rate_hz=introduction.info.rate_hz, device=introduction.info.device)
        try:
            _stream(line, ring, pipeline, publisher)
        finally:  # also where the device failed: what was tracked until then is sent and recorded
            pipeline.finish()
            line.tell("health", **pipeline.report(connected=False))


def _reception(setup: Setup, parser: FrameParser, introduction: InfoFrame) -> Reception:
    """Return the reception of a device; clock and gaps of a recording are those that it was recorded with."""
    if setup.replay is None:
        return Reception(parser, introduction)
    recorded, gaps = RecordedClock(setup.replay), RecordedGaps(setup.replay)
    return Reception(parser, introduction, new_clock=lambda *_: recorded, steps=recorded, known_gap=gaps.before)


def _pipeline(
    setup: Setup, run: str, reception: Reception, publisher: Publisher, link: RecordLink | None
) -> Pipeline:
    """Return the pipeline; what only this device is to blame for is no mistake in the config.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot be tracked, whatever the device.
    DeviceError
        If they can, but not with what this device's INFO says.
    """
    try:
        return Pipeline(setup, run, reception, publisher, link)
    except ConfigError as error:
        tracker_for(setup, _ANY_RATE_HZ)
        raise DeviceError(f"port {setup.config.device.port}: {error}") from error


def _introduction(
    line: ControlLine, ring: Ring, parser: FrameParser, setup: Setup, publisher: Publisher
) -> InfoFrame | None:
    """Wait for the INFO of the arm's device from the moment that the supervisor asks; None where a stop came."""
    port = setup.config.device.port
    handshake: Handshake | None = None
    wait = False
    while True:
        publisher.attend()
        try:
            said = line.hear(_LOOK_S)
        except SupervisorGone:
            return None
        if said is not None and said["what"] == "stop":
            return None
        if said is not None and said["what"] == "handshake":
            handshake, wait = Handshake(parser, port), bool(said["wait"])
        try:
            introduction = None if handshake is None else handshake.hear(ring.read())
            if introduction is not None:
                check_channels(introduction.info, setup.arm, port)
        except DeviceError as error:
            if not wait:
                raise DeviceError(f"{error}; {WAIT_ADVICE}") from error
            line.tell("waiting", sentence=str(error))
            handshake, introduction = Handshake(parser, port), None
        if introduction is not None:
            line.tell("heard")
            return introduction


def _stream(line: ControlLine, ring: Ring, pipeline: Pipeline, publisher: Publisher) -> None:
    next_health_s = time.monotonic() + _HEALTH_S
    abandoned_s: float | None = None
    asked_s, announced = 0.0, False
    looks = Looks()
    while True:
        publisher.attend()  # also where no samples come
        closed = ring.closed  # asked before reading: what was written before the close is then in it
        chunks = ring.read()
        now_s = time.monotonic()
        pipeline.accept(chunks, ring.dropped_chunks)
        if pipeline.streaming and not announced:
            line.tell("streaming")
        announced = pipeline.streaming
        if pipeline.awaits_info and now_s > asked_s + _ASK_S:
            asked_s = now_s
            line.tell("ask")
        if not chunks and (closed or (abandoned_s is not None and now_s > abandoned_s)):
            break
        if now_s >= next_health_s:
            line.tell("health", **pipeline.report(connected=not closed))
            give_back()
            next_health_s += _HEALTH_S * (1 + (now_s - next_health_s) // _HEALTH_S)
        if abandoned_s is None:
            abandoned_s = _when_abandoned(line, looks.wait_s(chunks, time.monotonic_ns()))
        else:
            time.sleep(_LOOK_S)


def _when_abandoned(line: ControlLine, wait_s: float) -> float | None:
    """Wait for the next look; where a stop was said meanwhile, return when to give up on the reader."""
    try:
        said = line.hear(wait_s)
    except SupervisorGone:
        return time.monotonic() + _ABANDONED_S
    if said is not None and said["what"] == "stop":
        return time.monotonic() + _ABANDONED_S
    return None
