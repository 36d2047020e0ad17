"""`limbplay export`: a motion as a file that other programs open."""

import argparse
import math
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from limbcal.command import Document, console, show
from limbcal.errors import ConfigError
from limbcal.note import documents
from playback.commands.source_options import add_source_arguments, open_source
from playback.export.sampled import Sampled, sample

Item = TypeVar("Item")

RATES_HZ = {".glb": 60.0, ".gltf": 60.0, ".csv": 60.0, ".mp4": 60.0, ".gif": 25.0, ".mcap": 60.0}
SIZES = {".mp4": (1280, 720), ".gif": (800, 450)}
#: The package that a format needs, and the extra that brings it.
NEEDS = {".glb": ("pygltflib", "view"), ".gltf": ("pygltflib", "view"), ".mp4": ("imageio_ffmpeg", "video")}
KEYED = (".glb", ".gltf")
#: glTF 2.0 turns the shorter way between keys, which is the other one from half a turn on; half of that is safe.
MOST_TURN_RAD = 0.5 * math.pi
MAX_RATE_HZ = 1000.0
MAX_GIF_HZ = 50.0  # browsers show faster ones slowly
MIN_GIF_HZ = 100.0 / 65535  # a picture's time is counted in hundredths of a second, in 16 bits
#: How many times faster or slower a motion may be; beyond, it is no motion to look at.
MIN_SPEED, MAX_SPEED = 1e-3, 1e3
SMALLEST, LARGEST = (320, 180), (3840, 2160)

#: As it stands in the help.
EXAMPLE = "limbplay export motion.csv --arm calibrated.toml --out motion.glb"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay export` takes."""
    add_source_arguments(parser)
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE",
        help=f"what to write: {', '.join(RATES_HZ)} by its suffix",
    )
    parser.add_argument("--trial", type=int, metavar="N", help="trial to write, by default the lowest")
    parser.add_argument("--rate-hz", type=float, metavar="R", help="frames a second (60; of a GIF 25)")
    parser.add_argument("--speed", type=float, default=1.0, metavar="X", help="how much faster it is to move (1)")
    parser.add_argument(
        "--size", metavar="WxH", help="of a film in pixels, both even (1280x720; of a GIF 800x450)"
    )
    parser.set_defaults(action=export)


def export(arguments: argparse.Namespace) -> Document:
    """Write the file; the answer says what is in it."""
    path: Path = arguments.out
    suffix = path.suffix.lower()
    mistakes = list(_mistakes(arguments, suffix))
    if mistakes:
        raise ConfigError(mistakes)
    _require(suffix)
    source = open_source(arguments)
    turn = MOST_TURN_RAD if suffix in KEYED else None
    motion = sample(source, arguments.trial, _rate_hz(arguments, suffix), arguments.speed, turn)
    _WRITERS[suffix](arguments, motion)
    answer = {
        "file": str(path),
        "format": suffix[1:],
        "source": motion.title,
        "arm": motion.movers[0].arm.name,
        "twin": motion.movers[1].arm.name if len(motion.movers) > 1 else None,
        "trial": motion.trial,
        "frames": len(motion.t),
        "rate_hz": motion.rate_hz,
        "speed": arguments.speed,
        "duration_s": motion.duration_s,
        "size": list(_size(arguments)) if suffix in SIZES else None,
        "bytes": path.stat().st_size,
        "notes": documents(source.notes),
    }
    show(f"{path}: {answer['frames']} frames of {motion.title}, trial {motion.trial}, {motion.duration_s:.3f} s")
    return answer


def _mistakes(arguments: argparse.Namespace, suffix: str) -> Iterator[str]:
    if suffix not in RATES_HZ:
        yield f"--out {arguments.out}: the suffix is {suffix!r}, expected one of {', '.join(RATES_HZ)}"
        return
    read = (arguments.source, arguments.reference, arguments.twin)
    if any(name is not None and Path(name).resolve() == arguments.out.resolve() for name in read):
        yield f"--out {arguments.out}: this file is read, and one trial would take its place; expected another"
    most = MAX_GIF_HZ if suffix == ".gif" else MAX_RATE_HZ
    rate_hz = _rate_hz(arguments, suffix)
    if suffix == ".gif" and 0.0 < rate_hz < MIN_GIF_HZ:
        yield f"--rate-hz is {rate_hz:g}, expected at least {MIN_GIF_HZ:.4g} for {suffix}"
    elif not (math.isfinite(rate_hz) and 0.0 < rate_hz <= most):
        yield f"--rate-hz is {rate_hz:g}, expected above 0 and at most {most:g} for {suffix}"
    if not MIN_SPEED <= arguments.speed <= MAX_SPEED:
        yield f"--speed is {arguments.speed:g}, expected from {MIN_SPEED:g} to {MAX_SPEED:g}"
    if arguments.size is not None and suffix not in SIZES:
        yield f"--size is given for {suffix}, expected only for {' and '.join(SIZES)}"
    elif arguments.size is not None:
        found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", arguments.size)
        sides = [int(side) for side in found.groups()] if found else []
        fit = [low <= side <= high for side, low, high in zip(sides, SMALLEST, LARGEST, strict=False)]
        if not (sides and all(fit) and not any(side % 2 for side in sides)):
            yield (
                f"--size is {arguments.size!r}, expected WxH in even pixels from {SMALLEST[0]}x{SMALLEST[1]} "
                f"to {LARGEST[0]}x{LARGEST[1]}"
            )


def _rate_hz(arguments: argparse.Namespace, suffix: str) -> float:
    return float(RATES_HZ[suffix] if arguments.rate_hz is None else arguments.rate_hz)


def _size(arguments: argparse.Namespace) -> tuple[int, int]:
    if arguments.size is None:
        return SIZES[arguments.out.suffix.lower()]
    width, height = arguments.size.split("x")
    return int(width), int(height)


def _require(suffix: str) -> None:
    """Say at once, before any work, what is not installed."""
    if suffix not in NEEDS:
        return
    package, extra = NEEDS[suffix]
    try:
        import_module(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        raise ConfigError(
            f"limbplay export to {suffix} needs the package {package.replace('_', '-')}, which is not installed; "
            f'pip install "limbcal[{extra}]" adds it'
        ) from error


def _room(name: str) -> ModuleType:
    """Import a writer when it is wanted: some of what they need comes with an extra."""
    return import_module(f"playback.export.{name}")


def _gltf(arguments: argparse.Namespace, motion: Sampled) -> None:
    _room("gltf").write_gltf(arguments.out, motion)


def _table(arguments: argparse.Namespace, motion: Sampled) -> None:
    _room("table").write_table(arguments.out, motion)


def _mp4(arguments: argparse.Namespace, motion: Sampled) -> None:
    size = _size(arguments)
    with _counted(_room("frames").pictures(motion, *size), len(motion.t)) as pictures:
        _room("mp4").write_mp4(arguments.out, pictures, size, motion.rate_hz)


def _gif(arguments: argparse.Namespace, motion: Sampled) -> None:
    with _counted(_room("frames").pictures(motion, *_size(arguments)), len(motion.t)) as pictures:
        _room("gif").write_gif(arguments.out, pictures, motion.rate_hz)


def _mcap(arguments: argparse.Namespace, motion: Sampled) -> None:
    with _counted(range(len(motion.t)), len(motion.t)) as frames:
        _room("foxglove").write_foxglove(arguments.out, motion, frames)


@contextmanager
def _counted(items: Iterable[Item], total: int) -> Iterator[Iterator[Item]]:
    """Pass items through, with a bar on stderr that counts them."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        yield iter(progress.track(items, total=total, description="frames"))


_WRITERS: dict[str, Callable[[argparse.Namespace, Sampled], None]] = {
    ".glb": _gltf,
    ".gltf": _gltf,
    ".csv": _table,
    ".mp4": _mp4,
    ".gif": _gif,
    ".mcap": _mcap,
}
