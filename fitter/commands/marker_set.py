"""`fitter marker-set`: a draft of a marker set from a recording, for the user to name."""

import argparse
from pathlib import Path

from fitter.commands.limb_kinematics import recordings_of
from fitter.commands.options import add_out, make_room
from fitter.functional.draft_marker_set import RIGID_M, draft_marker_set
from limbcal.command import Document, say_notes, show
from limbcal.errors import DeviceError
from limbcal.note import documents

#: As it stands in the help.
EXAMPLE = "fitter marker-set moving.c3d --out my-lab.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter marker-set` takes."""
    parser.add_argument(
        "files", nargs="+", type=Path, metavar="FILE", help="C3D or TRC in which every joint moves"
    )
    add_out(parser, "the draft, whose segments are to be named (.toml)")
    parser.set_defaults(action=draft)


def draft(arguments: argparse.Namespace) -> Document:
    """Write clusters of markers that keep their distances."""
    make_room(arguments.out, (".toml",), arguments.files)
    recordings, notes = recordings_of(arguments.files)
    names = tuple(dict.fromkeys(name for recording in recordings for name in recording.names))
    seen = [n for n in names if any((~r.missing[:, r.names.index(n)]).any() for r in recordings if n in r.names)]
    found = draft_marker_set(seen, [recording.of(seen) for recording in recordings])
    try:
        arguments.out.write_text(found.toml(arguments.out.stem), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{arguments.out}: cannot be written: {error.strerror}") from error
    say_notes(notes)
    for markers, segment in zip(found.clusters, found.perhaps, strict=True):
        show(f"{', '.join(markers)}{f'  (perhaps {segment})' if segment else ''}")
    show(f"{len(found.clusters)} clusters of {len(seen)} markers -> {arguments.out}: give each its segment's name")
    return {
        "out": str(arguments.out),
        "rigid_mm": 1e3 * RIGID_M,
        "clusters": [
            {"markers": list(markers), "scatter_mm": 1e3 * scatter, "perhaps": segment}
            for markers, scatter, segment in zip(found.clusters, found.scatter_m, found.perhaps, strict=True)
        ],
        "notes": documents(notes),
    }
