"""Errors of models on some trials, as rows of a table: always of the torque and of the simulated angles."""

from collections.abc import Mapping, Sequence

from arm.model import Arm, Floats
from fitter.diagnosis.held_out_error import Errors
from fitter.report.diagnosis_words import angle, units

#: One row of text cells.
Cells = tuple[str, ...]


def error_rows(arm: Arm, models: Sequence[Errors]) -> list[Cells]:
    """Return what models get wrong: torque of every joint, and angles; a column a model behind the first."""

    def torques(what: str, sizes: Sequence[Floats]) -> list[Cells]:
        return [
            (f"torque {j + 1}{what}, rms [{unit}]", *(f"{size[j]:.4g}" for size in sizes))
            for j, unit in enumerate(units(arm))
        ]

    rows = torques("", [one.torque_rms for one in models])
    raw = [size for one in models if (size := one.unfiltered_rms) is not None]
    if len(raw) == len(models):
        rows += torques(" unfiltered", raw)
    for what, unit, sizes in (
        ("angle", "deg", [one.angle_deg for one in models]),
        ("position", "m", [one.position_m for one in models]),
    ):
        known = [one for one in sizes if one is not None]
        rows += [
            (f"{what}, {name} [{unit}]", *(angle(one[name]) for one in known))
            for name in (known[0] if known else ())
        ]
    return rows


def by_name_rows(errors: Mapping[str, tuple[Errors, Errors]]) -> list[Cells]:
    """Return a row for each of some sets or trials, before and after in one cell."""

    def torque(one: Errors) -> str:
        return ", ".join(f"{size:.3g}" for size in one.torque_rms)

    def moved(one: Errors, name: str) -> str:
        return ", ".join(angle(sizes[name]) for sizes in (one.angle_deg, one.position_m) if sizes is not None)

    return [
        (
            name,
            *(torque(one) for one in both),
            *(moved(one, "mean") for one in both),
            *(moved(one, "rms") for one in both),
        )
        for name, both in errors.items()
    ]


#: Over the columns of `by_name_rows`, but for the first.
BY_NAME = (
    "torque, rms, before",
    "after",
    "angle [deg], position [m], mean, before",
    "after",
    "rms, before",
    "after",
)
