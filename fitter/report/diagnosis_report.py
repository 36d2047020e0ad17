"""The page that a diagnosis leaves behind: read from top to bottom, what is wrong and why."""

from collections.abc import Callable, Sequence
from pathlib import Path

from arm.arm_file import save_arm
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.diagnosis.finding import NamedCause
from fitter.diagnosis.held_out_error import Errors, Judged
from fitter.parallel.forked import side_by_side
from fitter.report import diagnosis_figures as figures
from fitter.report.diagnosis_errors import BY_NAME, by_name_rows, error_rows
from fitter.report.diagnosis_rivals import rivals, shown, table_rows
from fitter.report.diagnosis_traces import traces
from fitter.report.diagnosis_words import (
    assumptions,
    candidate_name,
    fell,
    groups,
    headline,
    measured,
    percent,
    place,
    sentence,
    when,
    whiteness,
)
from fitter.report.page import Page, Row
from limbcal.command import to_json, with_asked
from limbcal.errors import DeviceError
from limbcal.note import sentences

#: Rows of the table of dependences, and how often chance may give as much.
_ROWS, _CHANCE = 12, 0.05


def write_diagnosis(found: Diagnosis, out: Path) -> None:
    """Write all that a diagnosis leaves behind: ``diagnosis.json``, ``extended.toml``, the page and its pictures.

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    path = out / "diagnosis.json"
    try:
        path.write_text(to_json(with_asked(found.finding.document())), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written: {error.strerror}") from error
    save_arm(found.finding.arm, out / "extended.toml")
    write_report(found, out)


def write_report(found: Diagnosis, out: Path) -> None:
    """Write ``report.html`` and its pictures: ``diagnosis-residual.png``, ``-places``, ``-angles``, ``-gains``, ….

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    page, drawn = Page(f"Diagnosis of {found.regression.arm.name}", _lead(found)), _drawn(found)

    def picture(name: str, caption: str) -> None:
        if name not in drawn:
            return
        path = out / f"diagnosis-{name}.png"
        try:
            path.write_bytes(drawn[name])
        except OSError as error:
            raise DeviceError(f"{path}: cannot be written: {error.strerror}") from error
        page.picture(drawn[name], caption)

    page.section("What is wrong", headline(found))
    page.points([f"But {warning.text}." for warning in found.finding.warnings])
    picture("residual", "Torque that the model leaves, in the evaluating trials in which it is largest.")
    picture(
        "places",
        "Where the error lives: means over the evaluating trials, and where the middle half of the samples is.",
    )
    _cause(page, found)
    _rivals(page, found)
    picture("gains", "Share of the squared residual that each candidate takes away.")
    _gain(page, found)
    picture("angles", "Measured and simulated angles, in the evaluating trials in which they part most.")
    page.section("What is left", whiteness(found))
    picture("remainder", "What is left, against what it depends on: means over bins.")
    _dependences(page, found)
    page.section("The next experiment", found.finding.next_experiment)
    page.note("What was assumed", assumptions(found))
    page.note("What was done to the data", sentences(found.finding.notes))
    page.write(out / "report.html")


def _drawn(found: Diagnosis) -> dict[str, bytes]:
    """Return the pictures that this diagnosis calls for, by their names."""
    all_traces = traces(found)
    drawing: dict[str, Callable[[], bytes]] = {
        "places": lambda: figures.places_figure(found, all_traces),
        "angles": lambda: figures.angles_figure(found, all_traces),
        "residual": lambda: figures.residual_figure(found, all_traces),
    }
    if found.search.first:
        drawing["gains"] = lambda: _gains(found)
    if found.finding.discrepancy.joint:
        drawing["remainder"] = lambda: figures.remainder_figure(found, all_traces)
    return dict(zip(drawing, side_by_side(lambda name: drawing[name](), list(drawing)), strict=True))


def _lead(found: Diagnosis) -> str:
    learnt = sum(motion.learn for motion in found.motions)
    return (
        f"{learnt} trial{'s' * (learnt > 1)} learnt from, {len(found.motions) - learnt} held back; all errors on "
        "this page are those of the trials held back."
    )


def _cause(page: Page, found: Diagnosis) -> None:
    finding, several = found.finding, len(found.search.causes) > 1
    if finding.verdict == "none":
        page.section("The cause", "There is nothing to explain: no effect of the catalogue rises above the noise.")
        return
    if finding.verdict == "unexplained":
        page.section("The cause", _unexplained(found))
        return
    rest = (
        "no more than the sensors' noise is left"
        if finding.complete
        else (
            f"the residual has {finding.residual_size.times_noise:.3g} times the sensors' noise: "
            "the model is not complete"
        )
    )
    text = f"With {'them' if several else 'it'} in the model {rest}."
    if several:
        text += " The causes act together, and each is needed beside the others."
    if finding.verdict == "ambiguous":
        text += " Those listed together explain this data equally well; only another experiment can part them."
    page.section("The cause" if not several else "The causes", text)
    for number, group in enumerate(groups(found), 1):
        page.points([_described(one) for one in group])
        rows: list[Row] = [
            (one.effect, name, *measured(parameter), parameter.unit)
            for one in group
            for name, parameter in one.parameters.items()
        ]
        header = ("effect", "parameter", "value", "95 % interval", "unit")
        page.table(header, rows, f"Cause {number}" if several else "")


def _unexplained(found: Diagnosis) -> str:
    text = "Something is there that no effect of the catalogue explains; further down is what it depends on."
    if not found.search.causes:
        return text
    nearest = candidate_name(found.search.final.model.hypotheses[found.search.causes[0].place])
    return f"{text} The nearest is {nearest}, but an unknown function explains clearly more."


def _described(cause: NamedCause) -> str:
    where = ", ".join(part for part in (cause.effect, place(cause.joints), when(cause)) if part)
    among = (
        f" Its share of the belief among its equals is {percent(cause.support)}." if cause.support < 1.0 else ""
    )
    shares = {"learn": "learnt from", "evaluate": "held back"}
    taken = " and ".join(
        f"{percent(cause.takes_away[role])} on trials {said}"
        for role, said in shares.items()
        if role in cause.takes_away
    )
    gain = f" It took away {taken} of the squared residual." if taken else ""
    return f"{sentence(cause.effect)} ({where}).{gain}{among}"


def _rivals(page: Page, found: Diagnosis) -> None:
    if not found.search.first:
        page.section("The rivals", "The base model leaves no more than noise, so no effect had to be tried.")
        return
    page.section(
        "The rivals",
        "Every effect of the catalogue was fitted wherever it can be, together with masses and friction, and "
        "judged on trials that it was not fitted to (pushes and loads come and go, and are sought in all trials).",
    )
    named = found.search.causes if found.finding.verdict in ("named", "ambiguous") else []
    for number, cause in enumerate(named or [None], 1):
        rows, rest = shown(rivals(found, cause))
        beside = "leaves, of what the winner leaves" if named else "leaves, of what the first leaves"
        title = f"In the place of cause {number}, the others given" if len(named) > 1 else ""
        page.table(("candidate", "takes away", beside, "verdict"), table_rows(rows), title)
        names = ["; ".join(one.name for one in rest)] if rest else []
        page.note(f"{len(rest)} more, which take away next to nothing or come further behind", names)


def _gains(found: Diagnosis) -> bytes:
    named = found.search.causes if found.finding.verdict in ("named", "ambiguous") else []
    rows, _ = shown(rivals(found, named[0] if named else None))
    return figures.gains_figure(
        [one.name for one in rows], [one.gain for one in rows], [one.colour for one in rows]
    )


def _gain(page: Page, found: Diagnosis) -> None:
    finding, extended = found.finding, found.final is not found.search.base
    before, after, gain = finding.before, finding.after, finding.gain
    text = "Nothing was added to the model, so this is how well it does as it is."
    if extended:
        interval = "too few seconds for an interval"
        if gain.ci95 is not None:
            low, high = (percent(limit) for limit in gain.ci95)
            interval = f"95 % interval of the fall: {low} to {high}, by blocks of a second and trials drawn anew"
        kinds = ("angles", before.angle_deg, gain.angle), ("positions", before.position_m, gain.position)
        moved = " and ".join(f"{what} {fell(share)}" for what, sizes, share in kinds if sizes is not None)
        text = (
            f"With the cause in the model the torque error {fell(gain.torque)} ({interval}); the error of the "
            f"simulated {moved}. "
            "extended.toml is the arm with it, to be simulated."
        )
    page.section("The gain" if extended else "How well it simulates", text)
    if finding.polish is not None:
        page.points([f"{finding.polish.sentence[0].upper()}{finding.polish.sentence[1:]}."])
    header = ("on the trials held back", "before", "after")
    models = (before, after) if extended else (before,)
    rows: list[Row] = list(error_rows(found.regression.arm, models))
    page.table(header[: 1 + len(models)], rows)
    if finding.judged is not None:
        _judged(page, found, finding.judged, models)


def _judged(page: Page, found: Diagnosis, judged: Judged, models: Sequence[Errors]) -> None:
    own = (judged.before, judged.after)[: len(models)]
    header = ("on the trials that had no say in anything", "before", "after")
    page.table(header[: 1 + len(own)], list(error_rows(found.regression.arm, own)))
    if len(by_set := judged.by_set()) > 1:
        page.table(("set", *BY_NAME), list(by_name_rows(by_set)))
    if len(by_trial := judged.by_trial()) > max(1, len(by_set)):
        page.table(("trial", *BY_NAME), list(by_name_rows(by_trial)))


def _dependences(page: Page, found: Diagnosis) -> None:
    telling = [one for one in found.finding.discrepancy.dependences if one.p <= _CHANCE]
    if not telling:
        return
    page.table(
        ("torque left at", "depends on", "xi (0: not at all, 1: altogether)", "chance gives as much"),
        [
            (f"joint {one.joint}", one.variable, f"{one.xi:.2f}", f"{percent(one.p)} of the time")
            for one in sorted(telling, key=lambda one: -one.xi)[:_ROWS]
        ],
        "Single variables, whatever the shape (Chatterjee's rank correlation)",
    )
