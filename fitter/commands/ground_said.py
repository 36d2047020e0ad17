"""What `fitter dynamics --ground` says at the terminal."""

from collections.abc import Mapping, Sequence

import numpy as np
from rich.markup import escape
from rich.table import Table

from fitter.ground.ground_document import known_together, left_at_prior, segment_rows
from fitter.ground.ground_dynamics import GroundFit
from fitter.ground.ground_score import GroundScore
from limbcal.command import say, show
from limbcal.digits import NORMAL_95, with_half_width

_ROLES = {"learn": "learning", "evaluate": "evaluating"}


def say_ground(
    fit: GroundFit, scores: Mapping[str, GroundScore | None], names: Sequence[str], *, prior: bool
) -> None:
    """Print the segments, what the six equations leave, and what stayed at the prior."""
    total, std = fit.total_kg
    whole = " ± ".join(with_half_width(total, NORMAL_95 * std))
    show(
        _table(
            fit,
            names,
            f"{fit.arm.name}: {fit.samples} samples up to {fit.band_hz:.3g} Hz, {whole} kg in all",
            prior,
        )
    )
    for role, score in scores.items():
        if score is not None:
            said, with_plates = (score.squared_reduction(of) for of in (1, 2))
            show(
                f"{_ROLES[role]} trials: the ground's force is off by {score.force_rms_N[1]:.1f} N rms "
                f"({score.force_rms_N[0]:.1f} as it was, squared {-100.0 * said['force']:+.0f} %), its moment "
                f"about the base link by {score.moment_rms_N_m[1]:.1f} N m ({score.moment_rms_N_m[0]:.1f}, "
                f"squared {-100.0 * said['moment']:+.0f} %); with what the plates are off by "
                f"{score.force_rms_N[2]:.1f} N ({-100.0 * with_plates['force']:+.0f} %) and "
                f"{score.moment_rms_N_m[2]:.1f} N m ({-100.0 * with_plates['moment']:+.0f} %)"
            )
    zero, zero_std = fit.plates.value[3:], fit.plates.std[3:]
    off = ", ".join(" ± ".join(with_half_width(x, NORMAL_95 * s)) for x, s in zip(zero, zero_std, strict=True))
    say(f"beside these bodies the plates read {off} N along x, y and z of frame 0 too much")
    if prior:
        left = left_at_prior(fit)
        say(
            f"{len(left)} of {len(fit.names)} parameters are left at the prior: they are the table's, not measured"
        )
    together = known_together(fit)
    if together:
        say(f"{len(together)} combinations are known only together, such as {' with '.join(together[0][:4])}")


def _table(fit: GroundFit, names: Sequence[str], title: str, prior: bool) -> Table:
    table = Table(title=escape(title), title_justify="left")
    for column in (
        "segment",
        "mass [kg]",
        "±",
        "centre [mm]",
        "±",
        "radii of gyration [mm]",
        *(["learnt"] if prior else []),
    ):
        table.add_column(escape(column), justify="left" if column == "segment" else "right")
    for row in segment_rows(fit, names):
        mass, centre, inertia, learnt = row["mass_kg"], row["com_m"], row["inertia_kg_m2"], row["learnt"]
        assert isinstance(mass, dict) and isinstance(centre, dict)
        assert isinstance(inertia, dict) and isinstance(learnt, dict)
        value, half = with_half_width(mass["value"], NORMAL_95 * mass["std"])
        radii = 1e3 * np.sqrt(np.array(inertia["value"][:3]) / mass["value"])
        shares = (learnt["mass"], float(np.mean(learnt["com"])), float(np.mean(learnt["inertia"])))
        table.add_row(
            str(row["segment"]),
            value,
            half,
            " ".join(f"{1e3 * x:.0f}" for x in centre["value"]),
            " ".join(f"{1e3 * NORMAL_95 * x:.0f}" for x in centre["std"]),
            " ".join(f"{x:.0f}" for x in radii),
            *([" ".join(f"{share:.2f}" for share in shares)] if prior else []),
        )
    return table
