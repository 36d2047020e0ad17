"""`limbd recover`: a recording whose writer was killed becomes a clean file, and the clean file is proved."""

import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from rich.text import Text

from limbcal.command import console, show
from limbcal.errors import DataError, DeviceError
from limbcal.escaped import escaped
from protocol.recording import ARM_ATTACHMENT, CONFIG_ATTACHMENT, RecordingWriter
from protocol.recording_reader import Recorded, read_recording, recording_attachments


def recover(path: Path, out: Path | None = None) -> Mapping[str, object]:
    """Write all that can be read of a recording to a clean file, and read that back.

    Parameters
    ----------
    path : Path
    out : Path, optional
        Not there yet; ``NAME.recovered.mcap`` beside the recording unless given.

    Returns
    -------
    mapping
        What was found: ``file``, ``out``, ``messages``, ``topics``, ``seconds``, ``whole`` and ``warnings``.

    Raises
    ------
    DataError
        If nothing can be read of it, not even the arm and the config at its beginning.
    DeviceError
        If the clean file cannot be written, or does not hold what was read.
    """
    out = out or path.with_suffix(".recovered.mcap")
    attachments = {name: data.decode(errors="replace") for name, data in recording_attachments(path).items()}
    reader = read_recording(path)
    counts: Counter[str] = Counter()
    seal, first_ns, last_ns = hashlib.sha256(), 0, 0
    writer = RecordingWriter(out, attachments.get(ARM_ATTACHMENT, ""), attachments.get(CONFIG_ATTACHMENT, ""))
    try:
        with writer:
            for found in reader.payloads():
                writer.copy(*found)
                _seal(seal, found)
                first_ns = min(first_ns or found.t_ns, found.t_ns)
                last_ns = max(last_ns, found.t_ns)
                counts[found.topic] += 1
        if not counts and not {ARM_ATTACHMENT, CONFIG_ATTACHMENT} <= set(attachments):
            raise DataError(
                f"recording {path}: no message can be read; {' '.join(reader.warnings) or 'it is empty'}"
            )
        _prove(out, seal.hexdigest(), counts.total())
    except BaseException:
        out.unlink(missing_ok=True)
        raise
    for warning in reader.warnings:
        console.print(Text.assemble(("warning:", "yellow"), f" {escaped(warning)}"), soft_wrap=True)
    seconds = 1e-9 * (last_ns - first_ns)
    show(f"{out}: {counts.total()} messages, {seconds:.1f} s, written and read back")
    return {
        "file": str(path),
        "out": str(out),
        "messages": counts.total(),
        "topics": dict(counts),
        "seconds": seconds,
        "whole": not reader.cut and not reader.warnings,
        "warnings": reader.warnings,
    }


def _prove(out: Path, expected: str, count: int) -> None:
    reader, seal = read_recording(out), hashlib.sha256()
    for found in reader.payloads():
        _seal(seal, found)
    if reader.cut or reader.warnings or seal.hexdigest() != expected:
        raise DeviceError(f"{out} does not hold the {count} messages that were written to it; is the disk sound?")


def _seal(seal: "hashlib._Hash", found: Recorded) -> None:
    time = found.t_ns.to_bytes(8, "little")
    parts: Iterable[bytes] = (found.topic.encode(), found.payload, found.encoding.encode(), time)
    for part in parts:
        seal.update(len(part).to_bytes(8, "little") + part)
