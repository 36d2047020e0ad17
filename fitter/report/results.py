"""What a calibration leaves behind: the arm, its figures, the motions, and a report to look at."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.arm_file import save_arm
from arm.model import Arm
from fitter.data.motion_file import write_motion
from fitter.data.torque_target import has_unknown_target, target_of
from fitter.data.trial import Trial
from fitter.dynamics import dynamics_fit as dynamics
from fitter.dynamics.evaluation import motion_error
from fitter.dynamics.written import determined_by_data, save_calibrated
from fitter.kinematics import kinematics_fit as kinematics
from fitter.live.calibration import Calibration
from fitter.report import published
from fitter.report.assumptions import dynamics_assumptions, kinematics_assumptions
from fitter.report.calibration_page import CalibrationPage, Section, error_rows
from fitter.report.compared import Compared, geometry_by_name
from fitter.report.figures import Comparison
from fitter.report.parameter_table import parameter_table
from fitter.report.provenance import provenance
from limbcal.command import show, to_json
from limbcal.digits import plain
from limbcal.errors import DeviceError, LimbcalError
from limbcal.note import Note, of_source

Document = dict[str, object]


def write_results(
    calibration: Calibration,
    compared: Sequence[Compared],
    stream: Mapping[str, object],
    out: Path | None,
    made: Mapping[str, object] | None = None,
    notes: Sequence[Note] = (),
) -> Document:
    """Score a calibration, say how it does, and write it all down.

    Parameters
    ----------
    calibration : Calibration
    compared : sequence of Compared
        Arms whose values and errors stand next to it.
    stream : mapping
        What is to be said of the stream.
    out : Path or None
        Directory for ``calibrated.toml``, ``kinematics.json``, ``dynamics.json``, ``motions.npz`` and
        ``report.html``; None writes nothing.
    made : mapping, optional
        Of the stream's motions: ``learn``, ``evaluate``, ``expected``, ``lost_s``; it becomes ``trials``.
    notes : sequence of Note
        Of the stream; for the report.

    Returns
    -------
    dict
        ``stream``, ``kinematics`` and ``dynamics`` as `fitter kinematics` and `fitter dynamics` have them.

    Raises
    ------
    DeviceError
        If it cannot be written; the error has the document.
    """
    (learn, learn_tip), (evaluate, evaluate_tip) = calibration.scores("learn"), calibration.scores("evaluate")
    document: Document = {"stream": dict(stream)}
    geometry = calibration.kinematics()
    if geometry is not None and learn_tip is not None:
        document["kinematics"] = kinematics.document(geometry, learn_tip, evaluate_tip)
    if calibration.dynamics is not None and learn is not None:
        fields = dynamics.document(calibration.dynamics, learn, evaluate)
        document["dynamics"] = fields if made is None else {**fields, "trials": made}
    _show(calibration, document, compared)
    if out is not None:
        try:
            _write(calibration, document, compared, notes, out)
        except LimbcalError as error:  # a full disk takes no answer away
            error.document = document
            raise
    return document


def _write(
    calibration: Calibration,
    document: Document,
    compared: Sequence[Compared],
    notes: Sequence[Note],
    out: Path,
) -> None:
    arm = calibration.calibrated()
    try:
        out.mkdir(parents=True, exist_ok=True)
        for part in ("kinematics", "dynamics"):
            if part in document:
                (out / f"{part}.json").write_text(to_json(document[part]) + "\n", encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{out}: cannot be written: {error.strerror}") from error
    if calibration.dynamics is not None:
        fit = calibration.dynamics
        save_calibrated(arm, fit.base, determined_by_data(fit), out / "calibrated.toml")
    else:
        save_arm(arm, out / "calibrated.toml")
    trials = [*calibration.learn, *calibration.evaluate]
    if trials and calibration.dynamics is not None:
        simulated = [trial.q + motion_error(arm, trial) for trial in trials]
        _write_motions(arm, trials, simulated, out / "motions.npz")
        _write_report(calibration, document, compared, simulated, notes, out / "report.html")
        show(f"report: {out / 'report.html'}")


def _write_motions(
    arm: Arm, trials: Sequence[Trial], simulated: Sequence[NDArray[np.float64]], path: Path
) -> None:
    """Write measured motion with the targets that the law was given, and the simulated angles."""
    columns: dict[str, NDArray[np.generic]] = {
        "t": np.concatenate([trial.t for trial in trials]),
        "q": np.concatenate([trial.q for trial in trials]),
        "dq": np.concatenate([trial.dq for trial in trials]),
        "ddq": np.concatenate([trial.ddq for trial in trials]),
        "ref": np.concatenate([target_of(arm, trial) for trial in trials]),
        "trial": np.concatenate([np.full(len(trial.t), k) for k, trial in enumerate(trials, 1)]),
    }
    columns |= {f"simulated{j + 1}": np.concatenate(simulated)[:, j] for j in range(arm.n_joint)}
    write_motion(path, columns)


def _show(calibration: Calibration, document: Document, compared: Sequence[Compared]) -> None:
    """Show the same tables as the report has."""
    for section in _sections(calibration, compared):
        show(parameter_table(section.title, section.parameters, section.others))
    for name, values in error_rows(_part(document, "dynamics"), _part(document, "kinematics")):
        said = ", ".join(f"{role} {plain(value, 3)}" for role, value in values.items() if value is not None)
        show(f"{name}: {said}")


def _write_report(
    calibration: Calibration,
    document: Document,
    compared: Sequence[Compared],
    simulated: Sequence[NDArray[np.float64]],
    notes: Sequence[Note],
    path: Path,
) -> None:
    arm, trials = calibration.calibrated(), [*calibration.learn, *calibration.evaluate]
    turning = tuple(joint.type == "revolute" for joint in arm.joints)
    dynamics_fields = _part(document, "dynamics")
    fit, geometry = calibration.dynamics, calibration.kinematics()
    CalibrationPage(
        arm=arm,
        lead=f"{len(calibration.learn)} motions learnt from, {len(calibration.evaluate)} held back to evaluate.",
        sections=_sections(calibration, compared),
        errors=error_rows(dynamics_fields, _part(document, "kinematics")),
        assumptions=[
            *kinematics_assumptions(arm),
            *dynamics_assumptions(
                arm,
                lengths_learnt=calibration.kinematics() is not None,
                targets_found=any(has_unknown_target(arm, trial) for trial in trials),
            ),
        ],
        notes=[
            *notes,
            *(note for trial in trials for note in of_source(trial.notes, trial.name)),
            *(() if geometry is None else geometry.notes),
            *(() if fit is None else fit.notes),
        ],
        provenance=provenance(),
        motions=[
            Comparison(trial.name, trial.role != "evaluate", trial.t, trial.q, q, turning)
            for trial, q in zip(trials, simulated, strict=True)
        ],
        trials=_part(dynamics_fields or {}, "trials"),
        of_the_paper=published.ARM in (arm.name, *(c.name for c in compared)),
    ).write(path)


def _sections(calibration: Calibration, compared: Sequence[Compared]) -> list[Section]:
    """Return the fitted parameters, with those of other arms next to them."""
    sections: list[Section] = []
    geometry = calibration.kinematics()
    if geometry is not None:
        lengths = {c.name: geometry_by_name(c.arm) for c in compared}
        sections.append(Section("Geometry", geometry.parameters, lengths))
    if calibration.dynamics is not None:
        values = {c.name: c.parameters for c in compared}
        sections.append(Section("Dynamics", calibration.dynamics.parameters, values))
    if published.ARM in (calibration.arm.name, *(c.name for c in compared)):
        paper = {"Geometry": published.KINEMATICS, "Dynamics": published.DYNAMICS}
        sections = [replace(s, others={**s.others, "the paper": paper[s.title]}) for s in sections]
    return sections


def _part(document: Mapping[str, object], name: str) -> Mapping[str, object] | None:
    fields = document.get(name)
    assert fields is None or isinstance(fields, Mapping)
    return fields
