"""The page of `fitter kinematics --body … --report`: a person's limb, to hand on."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from fitter.functional.disjoint import coverage_factor
from fitter.functional.regression_centre import regression_centres
from fitter.limb.base_orientation import seen_or_posed
from fitter.limb.limb_fit import LimbFit
from fitter.limb.nan_statistics import nan_median
from fitter.report.figures import png
from fitter.report.limb_figures import angles_over_time, gaps_and_swaps, marker_errors, stick_figure
from fitter.report.page import Page
from fitter.report.provenance import provenance
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

Answer = Mapping[str, object]


def write_limb_page(
    path: Path, fit: LimbFit, answer: Answer, recordings: Sequence[MarkerRecording], notes: Sequence[Note]
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    fit : LimbFit
    answer : mapping
        The command's JSON document.
    recordings : sequence of MarkerRecording
        Learning ones, then evaluating ones.
    notes : sequence of Note
        All that was said.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    frames = answer["samples"]
    page = Page(fit.arm.name, f"{len(recordings)} recordings, {frames} frames in the fit")
    results(page, answer)
    _methods(page, fit)
    rivals = _rivals(fit)
    if rivals:
        page.table(["rival", "centre", "away from the fit [mm]", "its own error [mm]"], rivals)
    page.picture(
        png(stick_figure(fit)),
        "The middle frame of the fit. Red: where a centre lies with 95 %; green: axes.",
    )
    page.section("Angles")
    page.picture(png(angles_over_time(fit)), "Angles of eq. (1) in the frames of the fit.")
    names = [*fit.base.markers, *fit.bundle.markers.names]
    of_the_markers(page, answer, fit.trials.landmarks.values(), names, recordings, notes)
    page.write(path)


def of_the_markers(
    page: Page,
    answer: Answer,
    landmarks: Iterable[str],
    names: Sequence[str],
    recordings: Sequence[MarkerRecording],
    notes: Sequence[Note],
) -> None:
    """Say how far markers are off, which ones come and go, what was said, and where all that comes from."""
    page.section("Markers")
    _markers(page, answer)
    rms = dict(answer["marker_rms_mm"])["per_marker"]  # type: ignore[call-overload]
    known = [(name, float(x)) for name, x in rms.items() if x is not None]
    page.picture(png(marker_errors(known, set(landmarks))), "Distance of each marker.")
    page.picture(png(gaps_and_swaps(recordings, names, notes)), "Gaps and exchanged labels.")
    page.section("What was said")
    page.points([note.text for note in notes])
    page.section("Where it comes from")
    page.table(("", ""), provenance([recording.path for recording in recordings]).rows(), words=True)


def results(page: Page, answer: Answer) -> None:
    """Say lengths, centres and axes."""
    lengths, centres, axes = (dict(answer[k]) for k in ("lengths_m", "centres", "axes"))  # type: ignore[call-overload]
    page.section(
        "Segments", "Lengths with their 95 % intervals, by disjoint parts of the recordings and the prior."
    )
    page.table(
        ["segment", "length [mm]", "from", "to"],
        [[name, 1e3 * one["value"], *(1e3 * x for x in one["ci95"])] for name, one in lengths.items()],
    )
    page.section("Centres and axes", "Apart: how far disjoint trials, or halves of the only one, disagree, rms.")
    page.table(
        ["centre", "in", "sd [mm]", "apart [mm]"],
        [[name, one["segment"], one["std_mm"], one["apart_mm"]] for name, one in centres.items()],
    )
    page.table(
        ["axis", "in", "sd [°]", "apart [°]"],
        [[name, one["segment"], one["std_deg"], one["apart_deg"]] for name, one in axes.items()],
    )


def _methods(page: Page, fit: LimbFit) -> None:
    """Say how far the genetic algorithm's answer is from the bundle fit's, where it was asked for."""
    if fit.rivals is None:
        return
    page.section(
        "Genetic algorithm and bundle fit",
        "This limb is the genetic algorithm's own answer, found without starting values; ga+bundle is the bundle "
        "fit that begins with it. Cost: minus twice the log posterior on all frames, above the bundle fit's. "
        "Apart: from the bundle fit, rms.",
    )
    page.table(
        [
            "method",
            "markers off [mm rms]",
            "markers apart [mm]",
            "centres apart [mm]",
            "cost",
            "processor time [s]",
        ],
        [
            [
                name,
                1e3 * one.marker_rms_m,
                1e3 * one.apart_m,
                1e3 * one.centres_apart_m,
                one.cost,
                fit.rivals.found[name].seconds,
            ]
            for name, one in fit.rivals.compared.items()
        ],
    )


def _rivals(fit: LimbFit) -> list[list[str | float | None]]:
    """Return other methods' centres of the first joint, and how far they are from the fit's."""
    first = next(iter(fit.where.centres))
    joint, place = f"{first}_{fit.where.side}", fit.bundle.geometry.base_p
    rows: list[list[str | float | None]] = []
    for found in fit.functional:
        if found.joint == joint and found.parent == fit.base.segment and not found.unobservable.any():
            own = 1e3 * coverage_factor(found.n_part) * found.std_m
            rows.append(["SCoRE (95 %)", joint, 1e3 * float(np.linalg.norm(found.in_parent_m - place)), own])
    landmarks = {name: seen_or_posed(fit.trials, marker) for name, marker in fit.trials.landmarks.items()}
    for rival in regression_centres(landmarks):
        if rival.joint == joint:
            local = nan_median(np.einsum("nji,nj->ni", fit.base.R, rival.position_m - fit.base.p))
            if np.isfinite(local).all():
                error = 1e3 * rival.error_m if np.isfinite(rival.error_m) else None
                rows.append([rival.source, joint, 1e3 * float(np.linalg.norm(local - place)), error])
    return rows


def _markers(page: Page, answer: Answer) -> None:
    rows = []
    for role in ("learn", "evaluate"):
        one = dict(answer["marker_rms_mm"]).get(role)  # type: ignore[call-overload]
        if one is not None:
            rows.append([role, one["rms"], one["median"], one["max"], one["frames"]])
    page.table(["trials", "rms [mm]", "median", "most", "frames"], rows)
