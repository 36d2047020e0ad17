"""The recorder process: what the pipeline published, and the raw samples, into one MCAP file.

A disk that fails ends the recording, never the stream.
"""

import math
from pathlib import Path

import zmq

from daemon.control_line import ControlLine, SupervisorGone
from daemon.record_link import Context, Entry, RecordInlet
from limbcal.errors import DeviceError
from protocol.recording import RecordingWriter

_POLL_S = 0.1
#: The supervisor says stop when the pipeline has ended: an empty inlet then means that it said no goodbye. Where
#: the supervisor itself is gone, the pipeline may still be busy with what the reader left.
_QUIET_S = {"stop": 1.0, "gone": 10.0}


def run_recorder(line: ControlLine, endpoint: str, path: str, arm_toml: str, config_toml: str) -> None:
    """Record until the pipeline says that this was all.

    The supervisor hears ``ready``, ``linked`` once the pipeline is connected, ``disk-failed`` if the disk
    does, and at the end ``closed``.

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
    writer = RecordingWriter(file, arm_toml, config_toml)
    context: Context = zmq.Context()
    inlet = RecordInlet(context, endpoint)
    line.tell("ready")
    recording = _Recording(line, inlet, writer)
    try:
        recording.follow()
    finally:
        recording.close()
        inlet.close()
        context.term()


class _Recording:
    def __init__(self, line: ControlLine, inlet: RecordInlet, writer: RecordingWriter) -> None:
        self._line = line
        self._inlet = inlet
        self._writer = writer
        self._good = True
        self._messages = 0

    def follow(self) -> None:
        """Write what comes until the end is said, or nothing comes any more after a stop."""
        told, quiet_s, limit_s = False, 0.0, math.inf
        while not self._inlet.ended and quiet_s < limit_s:
            entry = self._inlet.receive(_POLL_S)
            if self._inlet.linked and not told:
                told = True
                self._line.tell("linked")
            self._record(entry)
            quiet_s = quiet_s + _POLL_S if entry is None and limit_s < math.inf else 0.0
            if limit_s == math.inf:
                limit_s = self._limit_s()

    def close(self) -> None:
        """Finish the file; one without a single message is taken away."""
        if self._good:
            try:
                self._writer.close()
            except DeviceError as error:
                self._disk_failed(error)
        if self._messages == 0:
            self._writer.path.unlink(missing_ok=True)
        self._line.tell("closed", messages=self._messages)

    def _record(self, entry: Entry | None) -> None:
        if not self._good:
            return
        try:
            if entry is None:
                self._writer.poll()
            else:
                self._writer.write(entry.topic, entry.payload, entry.t_ns)
                self._messages += 1
        except DeviceError as error:
            self._disk_failed(error)
            self._inlet.give_up()

    def _disk_failed(self, error: DeviceError) -> None:
        self._good = False
        self._line.tell("disk-failed", sentence=str(error))

    def _limit_s(self) -> float:
        """Return for how long the inlet may be empty: without end while nobody said stop."""
        try:
            said = self._line.hear()
        except SupervisorGone:
            return _QUIET_S["gone"]
        return _QUIET_S["stop"] if said is not None and said["what"] == "stop" else math.inf
