"""The page that a calibration leaves behind: what was found, how sure it is, and what it rests on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from arm.model import Arm
from fitter.report import published
from fitter.report.arm_figure import arm_figure
from fitter.report.figures import Comparison, angles_figure, error_figure
from fitter.report.glossary import glossary
from fitter.report.page import Page, Row
from fitter.report.parameter_listing import heading, parameter_rows
from fitter.report.provenance import Provenance
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note, sentences

Parameters = Mapping[str, FittedParameter]
_ROLES = {"learn": "learning", "evaluate": "evaluating"}
#: Kinds of notes that say how data was processed, and not what is doubtful about it.
_PROCESSING = frozenset({"derived", "drift", "filtered", "joined", "preamble", "resampled", "trimmed"})
_INTERVALS = (
    "± is the half-width of the 95 % interval: 95 of 100 such intervals hold the true value, if what was assumed "
    "below is so. Values are given to the digits that it leaves."
)


@dataclass(frozen=True)
class Section:
    """Fitted parameters under a heading, and the values of other arms by the arms' names."""

    title: str
    parameters: Parameters
    others: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class CalibrationPage:
    """What is on the page.

    Attributes
    ----------
    arm : Arm
        As it was calibrated.
    lead : str
    sections : sequence of Section
    errors : mapping from role to mapping
        Of the JSON documents: each row of the table of errors by its name, then by role.
    assumptions : sequence of str
    notes : sequence of Note
    provenance : Provenance
    motions : sequence of Comparison
        Measured and simulated motion; empty where nothing was simulated.
    trials : mapping, optional
        ``learn``, ``evaluate``, ``expected`` and ``lost_s`` of a stream.
    alarms : sequence of str
        Why the answer is not to be used; in red.
    of_the_paper : bool
        Whether the arm is the paper's, whose figures then stand next to ours.
    """

    arm: Arm
    lead: str
    sections: Sequence[Section]
    errors: Sequence[tuple[str, Mapping[str, float | None]]]
    assumptions: Sequence[str]
    notes: Sequence[Note]
    provenance: Provenance
    motions: Sequence[Comparison] = ()
    trials: Mapping[str, object] | None = None
    alarms: Sequence[str] = ()
    of_the_paper: bool = False

    def write(self, path: Path) -> None:
        """Write the page.

        Raises
        ------
        DeviceError
            If the file cannot be written.
        """
        page = Page(f"Calibration of {self.arm.name}", self.lead)
        for sentence in self.alarms:
            page.alarm(sentence)
        self._trials(page)
        page.points(sentences(note for note in self.notes if note.kind not in _PROCESSING))
        fitted = {name: p for section in self.sections for name, p in section.parameters.items()}
        page.section("The arm")
        page.picture(
            arm_figure(self.arm, fitted),
            "Links are solid along their length a, dotted along their offset d; joints are circles, bent to be "
            "seen apart; sensors are squares.",
        )
        for section in self.sections:
            page.section(section.title, _INTERVALS if section is self.sections[0] else "")
            rows = [row.cells for row in parameter_rows(section.parameters, section.others)]
            page.table(heading(section.others), rows)
        self._errors(page)
        page.section("What the symbols mean")
        names = [name for section in self.sections for name in section.parameters]
        page.table(("symbol", "meaning (j: number of the joint or link)"), glossary(names), words=True)
        page.section("What was assumed")
        page.points(self.assumptions)
        page.note("What was done to the data", sentences(note for note in self.notes if note.kind in _PROCESSING))
        page.section("Where this comes from")
        page.table(("", ""), self.provenance.rows(), words=True)
        page.write(path)

    def _trials(self, page: Page) -> None:
        if self.trials is None:
            return
        sentence = trials_sentence(self.trials)
        if trials_are_missing(self.trials):
            page.alarm(sentence)
        else:
            page.points([sentence])

    def _errors(self, page: Page) -> None:
        page.section("How well the calibrated arm moves like the measured one")
        header: tuple[str, ...] = ("error", *_ROLES.values())
        rows: list[Row] = [(name, *(values.get(role) for role in _ROLES)) for name, values in self.errors]
        if self.of_the_paper:
            header = (*header, "paper, learning", "paper, evaluating")
            kinds = ("mean", "max")
            rows = [(*row, *(_of_the_paper(str(row[0]), role, kinds) for role in _ROLES)) for row in rows]
        page.table(header, rows)
        if self.motions:
            like = " (the paper's Fig. 7 and 8 in one)" if self.of_the_paper else ""
            page.picture(angles_figure(self.motions), f"Measured and simulated joint angles{like}.")
            page.picture(error_figure(self.motions), "Error of each motion.")


def _of_the_paper(row: str, role: str, kinds: tuple[str, str]) -> float | None:
    for kind, value in zip(kinds, published.ANGLE_ERROR_DEG[role], strict=True):
        if row == f"simulated angle, {kind} [deg]":
            return value
    return None


def error_rows(
    dynamics: Mapping[str, object] | None, kinematics: Mapping[str, object] | None
) -> list[tuple[str, Mapping[str, float | None]]]:
    """Return the rows of the table of errors, from the JSON documents of both fits."""
    rows: list[tuple[str, Mapping[str, float | None]]] = []
    for document, key, title, unit in (
        (dynamics, "angle_error_deg", "simulated angle", "deg"),
        (kinematics, "tip_error_mm", "tip's displacement", "mm"),
    ):
        by_role = {} if document is None else document[key]
        assert isinstance(by_role, Mapping)
        for kind in ("mean", "max"):
            values = {role: fields[kind] for role, fields in by_role.items() if fields is not None}
            if values:
                rows.append((f"{title}, {kind} [{unit}]", values))
    torque = {} if dynamics is None else dynamics["torque_rms_N_m"]
    assert isinstance(torque, Mapping)
    explained = {} if dynamics is None else dynamics.get("explained", {})
    assert isinstance(explained, Mapping)
    for title, by_role in (("residual torque, rms [N m or N]", torque), ("torque explained", explained)):
        joints = max((len(values) for values in by_role.values() if values is not None), default=0)
        for j in range(joints):
            per_role = {role: values[j] for role, values in by_role.items() if values is not None}
            rows.append((f"joint {j + 1}, {title}", per_role))
    return rows


def trials_are_missing(trials: Mapping[str, object]) -> bool:
    """Say whether a stream held more motions than were taken in, or frames were lost."""
    expected, lost = trials.get("expected"), trials.get("lost_s")
    taken = sum(int(str(trials.get(role) or 0)) for role in _ROLES)
    fewer = isinstance(expected, int) and taken < expected
    return fewer or (isinstance(lost, int | float) and lost > 0.0)


def trials_sentence(trials: Mapping[str, object]) -> str:
    """Return how many motions were learnt from and held back, of how many, and what was lost."""
    learn, evaluate, expected, lost = (trials.get(key) for key in ("learn", "evaluate", "expected", "lost_s"))
    of = "" if expected is None else f", of {expected} that were made"
    gone = f"; {float(lost):.3g} s of frames lost" if isinstance(lost, int | float) and lost > 0.0 else ""
    return f"{learn} motions learnt from, {evaluate} held back to evaluate{of}{gone}."
