"""Recordings of markers, read, looked through and put right where that is safe."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from limbcal.errors import ConfigError
from limbcal.note import Note
from protocol.markers.c3d_file import read_c3d
from protocol.markers.clock import timed
from protocol.markers.crossings import uncrossed
from protocol.markers.force_notes import nan_forces
from protocol.markers.frame import stands_along, unit_of, up_of
from protocol.markers.labels import computed, doubled, names_of, prefixes, unnamed
from protocol.markers.marker_jumps import jumps
from protocol.markers.missing import ended, gaps, zeros
from protocol.markers.recording import MarkerRecording, RawRecording
from protocol.markers.swaps import Agreed, agreed, put_right
from protocol.markers.trc_file import read_trc

_READERS: dict[str, Callable[[Path], RawRecording]] = {".c3d": read_c3d, ".trc": read_trc}


@dataclass(frozen=True)
class Looked:
    """A recording, and what was wrong with it."""

    recording: MarkerRecording
    notes: tuple[Note, ...]


def read_markers(paths: Sequence[Path], progress: Callable[[int], None] | None = None) -> list[Looked]:
    """Read recordings of one person, and say what is wrong with each.

    Parameters
    ----------
    paths : sequence of Path
        C3D or TRC.
    progress : callable, optional
        Called with how many files are done.

    Raises
    ------
    ConfigError
        If a file cannot be opened, or has another ending.
    DataError
        If it holds no markers.
    """
    return look_at([read_raw(path) for path in paths], progress)


def look_at(raws: Sequence[RawRecording], progress: Callable[[int], None] | None = None) -> list[Looked]:
    """Say what is wrong with recordings of one person, and put right what is safe."""
    first = _agreed_up(raws, [_in_metres(raw) for raw in raws])
    recordings = [one.recording for one in first]
    most = agreed(recordings)
    found = []
    for k, one in enumerate(first):
        found.append(_put_right(one, [*recordings[:k], *recordings[k + 1 :]], most))
        if progress is not None:
            progress(k + 1)
    return found


def read_raw(path: Path) -> RawRecording:
    """Read a file as it says itself.

    Raises
    ------
    ConfigError
        If it cannot be opened, or has another ending.
    DataError
        If it holds no markers.
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise ConfigError(f"{path}: its name ends with {path.suffix or 'nothing'}, expected .c3d or .trc")
    try:
        return read(path)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from error


def _in_metres(raw: RawRecording) -> Looked:
    """Return a recording in metres with the names of its markers."""
    notes = [*prefixes(raw), *unnamed(raw), *ended(raw)]
    said, raw = timed(raw)
    notes += said
    said, is_computed = computed(raw)
    kept = ~np.array(is_computed, dtype=np.bool_)
    labels = tuple(label for label, keep in zip(raw.labels, kept, strict=True) if keep)
    names, points = names_of(labels), raw.points[:, kept]
    notes += [*said, *gaps(names, points, raw.rate_hz)]
    said, points = zeros(names, points, raw.rate_hz)
    notes += said
    said, unit = unit_of(points, raw.unit)
    notes += said
    positions = points * unit.factor
    said, up = up_of(positions, raw.up)
    notes += [*said, *doubled(names, positions), *nan_forces(raw.forces)]
    recording = MarkerRecording(raw.path, raw.rate_hz, names, positions, unit.name, up, raw.forces, raw.t0_s)
    return Looked(recording, tuple(notes))


def _agreed_up(raws: Sequence[RawRecording], looked: Sequence[Looked]) -> list[Looked]:
    """Let files whose persons do not stand tell up as those do that have the same header and one stance."""
    stances = [stands_along(one.recording.positions, raw.up) for raw, one in zip(raws, looked, strict=True)]
    found = []
    for raw, one, own in zip(raws, looked, stances, strict=True):
        others = {up for other, up in zip(raws, stances, strict=True) if other.up == raw.up and up}
        if own or len(others) != 1 or one.recording.up in others:
            found.append(one)
            continue
        up = others.pop()
        said = f"the header calls {raw.up} up, but" if raw.up else "nothing tells which axis points up, but"
        note = Note("up", f"{said} in other files of this call persons stand along {up}: taken for up here too")
        found.append(Looked(replace(one.recording, up=up), (*one.notes, note)))
    return found


def _put_right(one: Looked, others: Sequence[MarkerRecording], most: Agreed) -> Looked:
    recording = one.recording
    crossed, positions, leapt = uncrossed(recording, others)
    swapped, positions, exchanged = put_right(replace(recording, positions=positions), most)
    leaps = jumps(recording.names, positions, recording.rate_hz, leapt | exchanged)
    return Looked(replace(recording, positions=positions), (*one.notes, *crossed, *swapped, *leaps))
