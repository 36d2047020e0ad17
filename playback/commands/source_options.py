"""What the commands that play a stored motion take, and the source that it names."""

import argparse
from pathlib import Path

from arm.arm_file import load_arm
from limbcal.command import say, say_notes
from limbcal.errors import ConfigError
from playback.file_source import file_source
from playback.recording_source import recording_source
from playback.simulated_source import simulated_source
from playback.source import Source
from playback.twin import with_twin
from protocol.tables.files import TABLES

DEFAULT_ARM = "dd-arm"


def add_source_arguments(parser: argparse.ArgumentParser) -> None:
    """Add SOURCE, and what says which arm moves, after which targets, beside which twin."""
    parser.add_argument(
        "source",
        nargs="?",
        type=Path,
        metavar="SOURCE",
        help="a recording of limbd (.mcap) or joint motion (.csv, .npz, .parquet, .mat, .json …) to play",
    )
    parser.add_argument(
        "--columns",
        metavar="MAP",
        help='where foreign columns are and what they are in, such as "t=time:ms,q=angle{j}:deg"',
    )
    parser.add_argument(
        "--arm",
        metavar="ARM",
        help="arm file or built-in arm; by default the recording's own, and dd-arm for joint motion",
    )
    parser.add_argument(
        "--reference",
        type=Path,
        metavar="FILE",
        help="columns t, ref1… that the arm follows in a simulation under its law: in place of SOURCE --arm does, "
        "beside SOURCE --twin does",
    )
    parser.add_argument(
        "--twin",
        metavar="ARM|FILE",
        help="a virtual arm beside that of SOURCE, on one clock: an arm to simulate, or its joint motion",
    )


def open_source(arguments: argparse.Namespace) -> Source:
    """Return what the arguments name; what there is to say of the files is said.

    Raises
    ------
    ConfigError
        If they contradict each other, or an arm or a file is wrong.
    DataError
        If a file holds nothing to be played.
    """
    source = _open(arguments)
    say_notes(source.notes)
    return source


def _open(arguments: argparse.Namespace) -> Source:
    path, reference, arm, twin = arguments.source, arguments.reference, arguments.arm, arguments.twin
    if path is None and reference is None:
        raise ConfigError("a motion is missing: expected SOURCE or --reference")
    if path is not None and reference is not None and twin is None:
        raise ConfigError("SOURCE and --reference are both given: expected one, or --twin for what follows it")
    if path is None:
        if twin is not None:
            raise ConfigError("--twin is given without SOURCE: expected the motion that the twin is to go beside")
        if arm is None:
            raise ConfigError("--arm is missing: --reference needs the arm that is to be simulated")
        return simulated_source(reference, load_arm(arm), arguments.columns)
    source = _stored(path, arm, arguments.columns, twin is not None)
    if twin is None:
        return source
    return with_twin(source, twin, path if reference is None else reference, say, arguments.columns)


def _stored(path: Path, arm: str | None, columns: str | None, beside_twin: bool) -> Source:
    if path.suffix.lower() == ".mcap":
        return recording_source(path, None if arm is None else load_arm(arm))
    if path.suffix.lower() not in TABLES:
        expected = ", ".join((".mcap", *TABLES))
        raise ConfigError(f"{path}: the suffix is {path.suffix!r}, expected one of {expected}")
    if arm is None:
        say(f"no --arm given: tip and points are those of {DEFAULT_ARM}")
    return file_source(path, load_arm(arm or DEFAULT_ARM), columns, beside_twin)
