"""`limbd install`: units, the udev rule, the user and a first config, laid down under a prefix and taken away."""

import re
import sys
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from limbcal.command import show
from limbcal.errors import ConfigError, DeviceError

#: Where the files that are laid down come from: beside the packages, or where an installer has put them.
_HERE = Path(__file__).resolve().parents[2]
_SOURCES = (_HERE / "systemd", _HERE / "examples", Path(sys.prefix) / "share/limbcal/systemd")
#: What the units call by this path is called where it really is.
_BIN = "/opt/limbcal/.venv/bin"
#: What `ProtectHome=` hides from a service, whoever its user is (systemd.exec(5)).
_HOMES = (Path("/home"), Path("/root"), Path("/run/user"))
_HIDDEN, _SHOWN = "ProtectHome=yes", "ProtectHome=tmpfs"
_NEXT = (
    "systemd-sysusers",
    "udevadm control --reload",
    "systemctl daemon-reload",
    "edit /etc/limbcal/limbd.toml, then: systemctl enable --now limbd",
)


@dataclass(frozen=True)
class _Piece:
    """A file, where it goes, and whether it is the user's to change and so never overwritten or taken away."""

    source: str
    target: str
    theirs: bool = False


_PIECES = (
    _Piece("limbd.service", "etc/systemd/system/limbd.service"),
    _Piece("limbplay.service", "etc/systemd/system/limbplay.service"),
    _Piece("limbcal.sysusers", "etc/sysusers.d/limbcal.conf"),
    _Piece("99-limbcal.rules", "etc/udev/rules.d/99-limbcal.rules"),
    _Piece("limbd.toml", "etc/limbcal/limbd.toml", theirs=True),
    _Piece("limbplay.env", "etc/limbcal/limbplay.env", theirs=True),
)


def install(prefix: Path, dry_run: bool = False, remove: bool = False) -> Mapping[str, object]:
    """Lay the service's files down, or take them away; configs that are there already are left as they are.

    Parameters
    ----------
    prefix : Path
        ``/`` for this machine, or the root of an image.
    dry_run : bool
        Only say what would be done.
    remove : bool

    Returns
    -------
    mapping
        ``prefix``, ``done`` (a list of ``[what, path]``) and ``dry_run``.

    Raises
    ------
    ConfigError
        If the files to lay down cannot be found.
    DeviceError
        If one cannot be written.
    """
    done: list[tuple[str, str]] = []
    for piece in _PIECES:
        target = prefix / piece.target
        try:
            what = _take_away(target, piece, dry_run) if remove else _lay_down(target, piece, dry_run)
        except OSError as error:
            hint = "; are you root?" if isinstance(error, PermissionError) else ""
            raise DeviceError(f"{target}: {error.strerror}{hint}") from error
        done.append((what, str(target)))
        show(f"{'would be ' if dry_run and what in ('written', 'removed') else ''}{what}: {target}")
    if not remove and not dry_run:
        show("next:\n  " + "\n  ".join(_NEXT))
    return {"prefix": str(prefix), "dry_run": dry_run, "done": [list(one) for one in done]}


def _lay_down(target: Path, piece: _Piece, dry_run: bool) -> str:
    unit = re.sub(rf"{_BIN}/(\w+)", _called, _source(piece.source).read_text(encoding="utf-8"))
    text = unit.replace(_HIDDEN, _homes(), 1).encode()
    if target.exists() and (piece.theirs or target.read_bytes() == text):
        return "kept" if piece.theirs else "there already"
    if not dry_run:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text)
    return "written"


def _called(program: re.Match[str]) -> str:
    """Return a program's path as ExecStart= reads it: it parts words at spaces, and % begins a specifier."""
    return _quoted(Path(sys.executable).parent / program[1])


def _homes() -> str:
    """Return what a unit sees of homes: nothing, or of an environment that is in one no more than that."""
    named = {Path(sys.executable).parent, Path(sys.prefix), Path(sys.base_prefix), _HERE}
    needed = {place for path in named for place in (path, path.resolve()) if _is_below(place, _HOMES)}
    whole = sorted(place for place in needed if not _is_below(place, needed - {place}))
    return "\n".join([_SHOWN, *(f"BindReadOnlyPaths={_quoted(place)}" for place in whole)]) if whole else _HIDDEN


def _is_below(path: Path, folders: Collection[Path]) -> bool:
    return any(folder in path.parents for folder in folders)


def _quoted(path: Path) -> str:
    return '"' + str(path).replace("%", "%%") + '"'


def _take_away(target: Path, piece: _Piece, dry_run: bool) -> str:
    if not target.exists():
        return "not there"
    if piece.theirs:
        return "kept"
    if not dry_run:
        target.unlink()
    return "removed"


def _source(name: str) -> Path:
    for folder in _SOURCES:
        if (folder / name).is_file():
            return folder / name
    raise ConfigError(f"{name} is in none of {', '.join(map(str, _SOURCES))}; is limbcal installed whole?")
