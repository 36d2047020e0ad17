"""The page of `fitter dynamics --ground --report`: a person's masses, to hand on."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.ground.ground_document import known_together, left_at_prior, segment_rows
from fitter.ground.ground_dynamics import GroundFit
from fitter.ground.ground_score import GroundScore
from fitter.ground.ground_trial import GroundTrial
from fitter.report.figures import MEASURED, SIMULATED, png
from fitter.report.page import Page, Row
from fitter.report.provenance import provenance
from limbcal.digits import NORMAL_95
from limbcal.note import Note

_ROLES = {"learn": "learnt from", "evaluate": "held back"}


def write_ground_page(
    path: Path,
    fit: GroundFit,
    scores: Mapping[str, GroundScore | None],
    trials: Sequence[GroundTrial],
    names: Sequence[str],
    files: Sequence[Path],
    notes: Sequence[Note],
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    fit : GroundFit
    scores : mapping of str to GroundScore or None
        By role, ``learn`` and ``evaluate``.
    trials : sequence of GroundTrial
        Those that were held back, or those learnt from if there are none.
    names : sequence of str
        Of the arm's links.
    files : sequence of Path
        What was read.
    notes : sequence of Note
        All that was said.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    total, std = fit.total_kg
    page = Page(
        fit.arm.name,
        f"{total:.2f} ± {NORMAL_95 * std:.2f} kg in all; {fit.samples} samples up to {fit.band_hz:.3g} Hz",
    )
    page.section(
        "Segments",
        "With 95 % intervals. Learnt: the share of the prior's variance that the ground took away, of mass, "
        "centre and inertia; where it is 0 the number is the table's.",
    )
    page.table(
        ["segment", "mass [kg]", "±", "table [kg]", "centre [mm]", "±", "radii of gyration [mm]", "learnt"],
        [_segment(row) for row in segment_rows(fit, names)],
    )
    page.section("The ground", "What the bodies' motion leaves of the measured force and of its moment, rms.")
    page.table(
        ["trials", "force, table [N]", "learnt [N]", "moment, table [N m]", "learnt [N m]"],
        [
            [_ROLES[role], *score.force_rms_N, *score.moment_rms_N_m]
            for role, score in scores.items()
            if score is not None
        ],
    )
    worst = max(trials, key=lambda trial: float(np.mean((trial.wrench - trial.Y @ fit.values) ** 2)))
    page.picture(
        png(ground_figure(fit, worst)),
        f"{worst.name}, the trial of the largest residual: measured, by the table, and with what was learnt.",
    )
    together = [" with ".join(terms) for terms in known_together(fit)]
    page.note(f"{len(together)} combinations are known only together", together)
    left = left_at_prior(fit)
    page.note(f"{len(left)} of {len(fit.names)} parameters are left at the prior", left)
    page.section("What was said")
    page.points([note.text for note in notes])
    page.section("Where it comes from")
    page.table(("", ""), provenance(files).rows(), words=True)
    page.write(path)


def ground_figure(fit: GroundFit, trial: GroundTrial) -> Figure:
    """Draw the ground's vertical force and the size of its moment, measured and of both bodies."""
    up = -np.array(fit.arm.gravity_m_s2) / np.linalg.norm(fit.arm.gravity_m_s2)
    wrenches = [trial.wrench, trial.Y @ fit.before, trial.Y @ fit.values]
    wrenches = [lowpass(one, trial.dt_s, fit.band_hz, ends="even") for one in wrenches]
    figure = Figure(figsize=(9, 5), layout="constrained")
    force, moment = figure.subplots(2, 1, sharex=True)
    styles = (("measured", MEASURED, "-"), ("table", "0.6", "--"), ("learnt", SIMULATED, "-"))
    for wrench, (label, colour, line) in zip(wrenches, styles, strict=True):
        force.plot(trial.t, wrench[:, :3] @ up, line, color=colour, label=label)
        moment.plot(trial.t, np.linalg.norm(wrench[:, 3:], axis=1), line, color=colour)
    force.set(ylabel="vertical force [N]")
    moment.set(xlabel="time [s]", ylabel="moment about the\nbase link [N m]")
    force.legend(loc="upper right")
    return figure


def _segment(row: Mapping[str, object]) -> Row:
    mass, centre, inertia, learnt = (dict(row[k]) for k in ("mass_kg", "com_m", "inertia_kg_m2", "learnt"))  # type: ignore[call-overload]
    radii = 1e3 * np.sqrt(np.array(inertia["value"][:3]) / mass["value"])
    shares = (learnt["mass"], np.mean(learnt["com"]), np.mean(learnt["inertia"]))
    return [
        str(row["segment"]),
        f"{mass['value']:.3f}",
        f"{NORMAL_95 * mass['std']:.3f}",
        f"{mass['prior']:.3f}",
        _three(1e3 * np.array(centre["value"])),
        _three(1e3 * NORMAL_95 * np.array(centre["std"])),
        _three(radii),
        " ".join(f"{share:.2f}" for share in shares),
    ]


def _three(numbers: Floats) -> str:
    return " ".join(f"{x:.0f}" for x in numbers)
