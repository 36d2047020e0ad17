"""Which columns of a MOT or STO table hold a plate's force, its point and its moment, by their names."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from limbcal.errors import DataError

#: What a column says that it holds, in full words; they are no part of the plate's name.
_WORD = re.compile(r"force|torque|moment|(?<![a-z])(?:grf|grm|cop)", re.IGNORECASE)
#: … or in letters beside the axis: OpenSim's v, p and m, and the F, COP, M and T of plates' makers.
_LETTERS = {
    "v": "force", "f": "force", "force": "force", "grf": "force", "p": "point", "cop": "point",
    "m": "moment", "t": "moment", "torque": "moment", "moment": "moment", "grm": "moment",
}  # fmt: skip
#: A column whose axis has the letters beside it: ``ground_force_r_vx``, ``COPx1``.
_LETTERED = re.compile(
    r"(?P<plate>.*?)(?P<kind>force|torque|moment|(?<![a-z])(?:grf|grm|cop|[vpmft]))_?(?P<axis>[xyz])"
    r"(?P<after>\d*|[_.]\w*)",
    re.IGNORECASE,
)
#: One whose axis stands alone, so that a word must say it: ``ground_torque_r_x``.
_ALONE = re.compile(r"(?P<plate>.*)(?<![a-z])(?P<axis>[xyz])(?P<after>\d*|[_.]\w*)", re.IGNORECASE)
_AXES = "xyz"


@dataclass
class PlateColumns:
    """Where a plate's columns stand.

    Attributes
    ----------
    name : str
        As the columns of its force call it.
    force, point, moment : dict of str to int
        Column by axis. A force has all three axes, a point all or none. A moment without a point has all three;
        beside a point it is free, and such files often name it about the vertical only.
    """

    name: str = ""
    force: dict[str, int] = field(default_factory=dict)
    point: dict[str, int] = field(default_factory=dict)
    moment: dict[str, int] = field(default_factory=dict)


def plate_columns(names: Sequence[str], path: Path) -> list[PlateColumns]:
    """Sort a table's columns by plates, in the order in which these come.

    Parameters
    ----------
    names : sequence of str
        Of all columns.
    path : Path
        The file, for errors.

    Raises
    ------
    DataError
        If a plate's column stands twice, axes are missing, a force has neither a point nor a moment, or a point or
        moment has no force.
    """
    found: dict[tuple[str, ...], PlateColumns] = {}
    for k, name in enumerate(names):
        read = _read(name)
        if read is None:
            continue
        key, called, kind, axis = read
        plate = found.setdefault(key, PlateColumns())
        if kind == "force":
            plate.name = plate.name or called
        of: dict[str, int] = getattr(plate, kind)
        if axis in of:
            raise DataError(
                f"{path}: columns {names[of[axis]]!r} and {name!r} are both {axis} of one plate's {kind}, "
                f"expected one"
            )
        of[axis] = k
    plates = []
    for plate in found.values():
        if not plate.force:
            _require_no_plate(plate, names, path)
            continue
        _require_whole(plate, names, path)
        plates.append(plate)
    return plates


def _read(name: str) -> tuple[tuple[str, ...], str, str, str] | None:
    """Return what tells the plate from others, its name, what of it a column holds and the axis; or None."""
    lettered = _LETTERED.fullmatch(name)
    found = lettered or _ALONE.fullmatch(name)
    if found is None:
        return None
    words = _WORD.findall(found["plate"] + found["after"])
    if lettered is None and not words:
        return None
    kind = _LETTERS[(words[-1] if lettered is None else lettered["kind"]).lower()]
    parts = re.findall(r"[a-z0-9]+", _WORD.sub(" ", f"{found['plate']} {found['after']}").lower())
    called = (found["plate"].rstrip("_") + found["after"]).strip("_.") or "force"
    return tuple(parts), called, kind, found["axis"].lower()


def _require_no_plate(plate: PlateColumns, names: Sequence[str], path: Path) -> None:
    """Refuse a point or a moment without a force; other columns may end alike, such as OpenSim's ``pelvis_tx``."""
    columns = [names[k] for k in (*plate.point.values(), *plate.moment.values())]
    unmatched = [name for name in columns if _WORD.search(name) or re.search(r"(?<![a-z])[mp]_?[xyz]", name, re.I)]
    if unmatched:
        raise DataError(
            f"{path}: column {unmatched[0]!r} is of no plate with a force, expected a plate's point and moment "
            f"to be named like its force, such as ground_force_1_vx, ground_force_1_px and ground_torque_1_x"
        )


def _require_whole(plate: PlateColumns, names: Sequence[str], path: Path) -> None:
    whole = {"force": plate.force, "point": plate.point}
    if not plate.point:
        whole["moment"] = plate.moment
    for kind, of in whole.items():
        missing = [axis for axis in _AXES if axis not in of]
        if of and missing:
            there = ", ".join(names[k] for k in of.values())
            raise DataError(
                f"{path}: the {kind} of plate {plate.name!r} has {there} and no column for "
                f"{' and '.join(missing)}, expected all of x, y and z"
            )
    if not plate.point and not plate.moment:
        raise DataError(
            f"{path}: plate {plate.name!r} has a force but neither a point nor a moment, so that its place "
            f"is not known, expected columns such as ground_force_1_px or ground_torque_1_x"
        )
