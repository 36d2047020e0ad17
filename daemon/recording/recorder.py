"""The recorder process: what the pipeline published, and the raw samples, into MCAP files.

A disk that fails pauses the recording, never the stream.
"""

import math
import time
from contextlib import ExitStack
from pathlib import Path

import zmq

from daemon.process.control_line import ControlLine, SupervisorGone
from daemon.recording.record_link import Context, RecordInlet
from daemon.recording.segments import Limits, Segments
from limbcal.allocator import give_back, large_blocks_kept
from limbcal.errors import DeviceError

#: How long messages are waited for before one looks for a stop, as long as they gather, and how often memory is
#: given back [s].
_POLL_S = 0.25
_GIVE_BACK_S = 10.0
#: The supervisor says stop when the pipeline has ended: an empty inlet then means that it said no goodbye. Where
#: the supervisor itself is gone, the pipeline may still be busy with what the reader left.
_QUIET_S = {"stop": 1.0, "gone": 10.0}


def run_recorder(
    line: ControlLine, endpoint: str, path: str, arm_toml: str, config_toml: str, limits: Limits
) -> None:
    """Record until the pipeline says that this was all.

    The supervisor hears ``ready``, ``linked`` once the pipeline is connected, ``disk-failed`` when nothing can be
    recorded any more, ``recording`` with each further file, and at the end ``closed``.

    Raises
    ------
    DeviceError
        If the file cannot be made.
    """
    file = Path(path)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DeviceError(f"record.directory {file.parent} cannot be made: {error.strerror}") from error
    large_blocks_kept()
    with ExitStack() as stack:
        context: Context = zmq.Context()
        stack.callback(context.term)
        inlet = RecordInlet(context, endpoint)
        stack.callback(inlet.close)

        def pause(sentence: str) -> None:
            line.tell("disk-failed", sentence=sentence)
            inlet.tell(None, segments.removed)

        def resume(path: str) -> None:
            line.tell("recording", path=path)
            inlet.tell(path, segments.removed)

        segments = Segments(file, (arm_toml, config_toml), limits, pause, resume)
        line.tell("ready")
        try:
            _follow(line, inlet, segments)
        finally:
            segments.close()
            line.tell("closed", messages=segments.messages, lost=segments.lost, paused=segments.ever_paused)


def _follow(line: ControlLine, inlet: RecordInlet, segments: Segments) -> None:
    """Write what comes until the end is said, or nothing comes any more after a stop."""
    announced, quiet_s, limit_s, given_s = False, 0.0, math.inf, time.monotonic()
    while not inlet.ended and quiet_s < limit_s:
        entries = inlet.receive(_POLL_S)
        if inlet.linked and not announced:
            announced = True
            line.tell("linked")
        segments.write(entries)
        if (now_s := time.monotonic()) > given_s + _GIVE_BACK_S:
            given_s = now_s
            give_back()
        quiet_s = quiet_s + _POLL_S if not entries and limit_s < math.inf else 0.0
        if limit_s == math.inf:
            limit_s = _limit_s(line)


def _limit_s(line: ControlLine) -> float:
    """Return for how long the inlet may be empty: without end while nobody said stop."""
    try:
        said = line.hear()
    except SupervisorGone:
        return _QUIET_S["gone"]
    return _QUIET_S["stop"] if said is not None and said["what"] == "stop" else math.inf
