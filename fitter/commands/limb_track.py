"""`fitter track MARKERS…`: recordings of markers to the motion of a calibrated arm."""

import argparse
import time
from pathlib import Path

import numpy as np
from rich.progress import Progress

from arm.body.isb_angles import isb_angles
from fitter.commands.arm_option import questioned_arm
from fitter.commands.limb_export import check_export, export
from fitter.commands.limb_kinematics import recordings_of
from fitter.commands.options import MOTION_SUFFIXES, make_room
from fitter.data.motion_file import write_motion
from fitter.limb.json_document import of_markers, rms_mm
from fitter.limb.marked_arm import marked_arm
from fitter.limb.marker_errors import beyond_skin
from fitter.limb.tracking import track_limb
from limbcal.command import Document, console, say_notes, show
from limbcal.errors import ConfigError
from limbcal.note import documents, of_source
from protocol.tables.columns import BASE_ROLES

#: What recordings of markers end with.
MARKER_SUFFIXES = (".c3d", ".trc")
_NOT_HERE = (("zero", None), ("initial_q", None), ("columns", None), ("rate_hz", None))


def has_markers(paths: list[Path]) -> bool:
    """Whether files are recordings of markers.

    Raises
    ------
    ConfigError
        If only some are.
    """
    markers = [path.suffix.lower() in MARKER_SUFFIXES for path in paths]
    if any(markers) and not all(markers):
        other = paths[markers.index(False)]
        raise ConfigError(f"{other}: it is no recording of markers but others are, expected files of one kind")
    return any(markers)


def limb_track(arguments: argparse.Namespace) -> Document:
    """Track markers in all recordings and write the motion into one file."""
    mistakes = [
        f"--{name.replace('_', '-')} is given, expected it only with accelerations"
        for name, usual in _NOT_HERE
        if getattr(arguments, name) != usual
    ]
    if mistakes:
        raise ConfigError(mistakes)
    arm = questioned_arm(arguments.arm)
    marked = marked_arm(arm)
    make_room(arguments.out, MOTION_SUFFIXES, arguments.raw)
    check_export(arguments.export, motions=True)
    recordings, notes = recordings_of(arguments.raw)
    began = time.perf_counter()
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("tracking", total=len(recordings))
        tracked = track_limb(arm, recordings, progress=lambda done: bar.update(task, completed=done))
    seconds = time.perf_counter() - began
    names = [Path(recording.path).stem for recording in recordings]
    labels = [name if names.count(name) == 1 else f"{k + 1}.{name}" for k, name in enumerate(names)]
    columns: dict[str, np.ndarray] = {
        "t": np.concatenate([one.t for one in tracked]),
        "q": np.concatenate([one.q for one in tracked]),
        "q_std": np.concatenate([one.q_std for one in tracked]),
    }
    poses = [one.base for one in tracked if one.base is not None]
    if poses:
        columns |= dict(zip(BASE_ROLES, np.concatenate(poses).T, strict=True))
    angles = isb_angles(arm, columns["q"])
    columns |= dict(zip(angles.names, angles.values.T, strict=True))
    if len(tracked) > 1:
        longest = f"U{max(map(len, labels))}"
        rows = [np.full(len(one.t), label, dtype=longest) for one, label in zip(tracked, labels, strict=True)]
        columns["trial"] = np.concatenate(rows)
    write_motion(arguments.out, columns)
    for one, recording in zip(tracked, recordings, strict=True):
        far = beyond_skin(marked.names, one.distance_m)
        notes += of_source([*one.notes, *far], Path(recording.path).name)
    say_notes(notes)
    distances = np.concatenate([one.distance_m for one in tracked])
    rms: dict[str, object] = dict(of_markers(distances, len(marked.markers.names)))
    rms["per_marker"] = {name: rms_mm(distances[:, m]) for m, name in enumerate(marked.names)}
    show(
        f"{len(distances)} frames in {len(tracked)} trial(s), markers off by {rms['rms']:.1f} mm rms, "
        f"{rms['median']:.1f} median -> {arguments.out}"
    )
    exported = export(arguments.export, arm, tracked, labels)
    return {
        "method": "markers",
        "out": str(arguments.out),
        "frames": len(distances),
        "trials": len(tracked),
        "seconds": seconds,
        "marker_rms_mm": rms,
        "exported": exported,
        "isb": {"angles": list(angles.names), "missing": dict(angles.missing)},
        "notes": documents(notes),
    }
