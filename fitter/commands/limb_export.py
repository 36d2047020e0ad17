"""`--export FILE…`: a person's limb and its motion as files that OpenSim and biorbd open."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from arm.model import Arm
from fitter.commands.options import make_room
from fitter.export.biomod_model import biomod_model
from fitter.export.motion_tables import coordinates_mot, marker_places, markers_trc
from fitter.export.osim_model import osim_model
from fitter.limb.tracking import TrackedLimb
from limbcal.command import show
from limbcal.errors import ConfigError, DeviceError

#: Endings of models, and of motions.
MODELS, MOTIONS = (".osim", ".bioMod"), (".mot", ".trc")


def add_export(parser: argparse._ActionsContainer, motions: bool) -> None:
    """Add ``--export``; a calibration has no motion to hand on."""
    what = "the arm for OpenSim (.osim) or biorbd (.bioMod)"
    if motions:
        what += ", its angles (.mot), its markers as the arm has them (.trc)"
    parser.add_argument(
        "--export", nargs="+", type=Path, default=[], metavar="FILE", help=f"for others: {what}, by the ending"
    )


def check_export(paths: Sequence[Path], motions: bool) -> None:
    """Refuse endings that are none before any work.

    Raises
    ------
    ConfigError
        If a file ends otherwise, or the folder is not there.
    """
    known = (*MODELS, *(MOTIONS if motions else ()))
    for path in paths:
        make_room(path)
        if path.suffix.lower() not in [one.lower() for one in known]:
            found = path.suffix or "nothing"
            raise ConfigError(f"--export {path}: its name ends with {found}, expected {', '.join(known)}")


def export(
    paths: Sequence[Path], arm: Arm, tracked: Sequence[TrackedLimb] = (), labels: Sequence[str] = ()
) -> list[str]:
    """Write files, and return which; of several trials each motion has its own, with the trial's name in it.

    Parameters
    ----------
    paths : sequence of Path
    arm : Arm
    tracked : sequence of TrackedLimb
    labels : sequence of str
        Names of their trials.

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    written: list[str] = []
    for path in paths:
        suffix = path.suffix.lower()
        if suffix in (".osim", ".biomod"):
            _write(path, osim_model(arm) if suffix == ".osim" else biomod_model(arm), written)
            continue
        for one, label in zip(tracked, labels, strict=True):
            own = path if len(tracked) == 1 else path.with_stem(f"{path.stem}_{label}")
            if suffix == ".mot":
                text = coordinates_mot(arm, one.t, one.q, one.base)
            else:
                rate_hz = (len(one.t) - 1) / (one.t[-1] - one.t[0]) if len(one.t) > 1 else 1.0
                names = [marker.name for marker in arm.markers]
                text = markers_trc(own.name, names, one.t, marker_places(arm, one.q, one.base), rate_hz)
            _write(own, text, written)
    if written:
        show(f"exported: {', '.join(written)}")
    return written


def _write(path: Path, text: str, written: list[str]) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written: {error.strerror or error}") from error
    written.append(str(path))
