"""`fitter markers`: what a C3D or TRC file holds, and what is wrong with it."""

import argparse
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from limbcal.command import Document, console, show
from limbcal.escaped import escaped
from limbcal.note import Note
from protocol.markers.force_notes import moves
from protocol.markers.marker_files import Looked, read_markers
from protocol.markers.missing import SHORTEST_S
from protocol.markers.recording import runs

#: As it stands in the help.
EXAMPLE = "fitter markers static.c3d walking.c3d"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter markers` takes."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="C3D or TRC, of one person")
    parser.set_defaults(action=look_through)


def look_through(arguments: argparse.Namespace) -> Document:
    """Say what the files hold, and what is wrong with them."""
    bar = Progress(TextColumn("reading"), BarColumn(), MofNCompleteColumn(), console=console, transient=True)
    with bar:
        task = bar.add_task("reading", total=len(arguments.files))
        found = read_markers(arguments.files, lambda done: bar.update(task, completed=done))
    documents = [_document(one) for one in found]
    if not arguments.json:
        _show(found)
    return {"files": documents, "notes": [_note(note) for one in found for note in one.notes]}


def _document(one: Looked) -> Document:
    recording = one.recording
    return {
        "path": recording.path,
        "rate_hz": recording.rate_hz,
        "frames": len(recording.positions),
        "unit": recording.unit,
        "up": recording.up or None,
        "markers": [
            {
                "name": name,
                "missing": float(missing.mean()),
                "longest_gap_s": _longest(missing) / recording.rate_hz,
            }
            for name, missing in zip(recording.names, recording.missing.T, strict=True)
        ],
        "forces": [
            {"name": force.name, "rate_hz": force.rate_hz, "moves": moves(force)} for force in recording.forces
        ],
        "notes": [_note(note) for note in one.notes],
    }


def _note(note: Note) -> Document:
    return {
        "kind": note.kind,
        "markers": list(note.columns),
        "from_s": note.from_s,
        "to_s": note.to_s,
        "text": note.text,
    }


def _longest(missing: np.ndarray) -> int:
    return max((last - first for first, last in runs(missing)), default=0)


def _show(found: list[Looked]) -> None:
    table = Table(title="recordings", title_justify="left")
    for name in (
        "file",
        "frames",
        "rate [Hz]",
        "unit",
        "up",
        "markers",
        f"with gaps over {SHORTEST_S:g} s",
        "forces",
    ):
        table.add_column(name)
    for one in found:
        recording = one.recording
        longest = [_longest(missing) / recording.rate_hz for missing in recording.missing.T]
        gappy = sum(gap >= SHORTEST_S for gap in longest)
        loaded = sum(map(moves, recording.forces))
        forces = f"{loaded} of {len(recording.forces)} loaded" if recording.forces else "none"
        numbers = (str(len(recording.positions)), f"{recording.rate_hz:.4g}", recording.unit, recording.up or "?")
        name = escape(escaped(Path(recording.path).name))
        table.add_row(name, *numbers, str(len(recording.names)), str(gappy), forces)
    show(table)
    for one in found:
        for note in one.notes:
            when = "" if note.from_s is None else f" ({note.from_s:.2f} to {note.to_s:.2f} s)"
            show(f"{Path(one.recording.path).name}: [{note.kind}] {note.text}{when}")
