"""What a calibration leaves behind: the arm, its figures, the motions, and a report to look at."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.arm_file import save_arm
from arm.model import Arm
from fitter.data.motion_file import write_motion
from fitter.data.trials import Trial
from fitter.dynamics import dynamics_fit as dynamics
from fitter.dynamics.evaluation import motion_error
from fitter.dynamics.learned_torque import target_of
from fitter.kinematics import fit as kinematics
from fitter.live.calibration import Calibration
from fitter.report import published
from fitter.report.compared import Compared, geometry_by_name
from fitter.report.figures import Comparison, angles_figure, error_figure
from fitter.report.page import Page, parameter_rows
from limbcal.command import show, to_json
from limbcal.errors import DeviceError

Document = dict[str, object]


def write_results(
    calibration: Calibration, compared: Sequence[Compared], stream: Mapping[str, object], out: Path | None
) -> Document:
    """Score a calibration, say how it does, and write it all down.

    Parameters
    ----------
    calibration : Calibration
    compared : sequence of Compared
        Arms to print beside it; the first one's values go into the report.
    stream : mapping
        What is to be said of the stream.
    out : Path or None
        Directory for ``calibrated.toml``, ``kinematics.json``, ``dynamics.json``, ``motions.npz`` and
        ``report.html``; None writes nothing.

    Returns
    -------
    dict
        ``stream``, ``kinematics`` and ``dynamics`` as `fitter kinematics` and `fitter dynamics` have them.
    """
    arm = calibration.calibrated()
    (learn, learn_tip), (evaluate, evaluate_tip) = calibration.scores("learn"), calibration.scores("evaluate")
    document: Document = {"stream": dict(stream)}
    geometry = calibration.kinematics()
    if geometry is not None and learn_tip is not None:
        document["kinematics"] = kinematics.document(geometry, learn_tip, evaluate_tip)
    if calibration.dynamics is not None and learn is not None:
        document["dynamics"] = dynamics.document(calibration.dynamics, learn, evaluate)
        for role, s in (("learning", learn), ("evaluating", evaluate)):
            if s is not None:
                show(f"{role}: simulated angle off by {s.angle_mean_deg:.3g}° mean, {s.angle_max_deg:.3g}° max")
    if out is None:
        return document
    try:
        out.mkdir(parents=True, exist_ok=True)
        for part in ("kinematics", "dynamics"):
            if part in document:
                (out / f"{part}.json").write_text(to_json(document[part]) + "\n", encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{out}: cannot be written: {error.strerror}") from error
    save_arm(arm, out / "calibrated.toml")
    trials = [*calibration.learn, *calibration.evaluate]
    if trials and calibration.dynamics is not None:
        simulated = [trial.q + motion_error(arm, trial) for trial in trials]
        _write_motions(arm, trials, simulated, out / "motions.npz")
        _write_report(calibration, document, compared, simulated, out / "report.html")
        show(f"report: {out / 'report.html'}")
    return document


def _write_motions(
    arm: Arm, trials: Sequence[Trial], simulated: Sequence[NDArray[np.float64]], path: Path
) -> None:
    """Write measured motion with the targets that the law was given, and beside it the simulated angles."""
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


def _write_report(
    calibration: Calibration,
    document: Document,
    compared: Sequence[Compared],
    simulated: Sequence[NDArray[np.float64]],
    path: Path,
) -> None:
    arm, trials = calibration.calibrated(), [*calibration.learn, *calibration.evaluate]
    page = Page(
        f"Calibration of {arm.name}",
        f"{len(calibration.learn)} motions learnt from, {len(calibration.evaluate)} held back to evaluate; "
        "no torque was measured.",
    )
    page.section(
        "How well the calibrated arm moves like the measured one",
        "Both under the same control. The paper's figures are of its own arm (section 8.2).",
    )
    page.table(("motions", "mean [deg]", "max [deg]", "paper, mean", "paper, max"), _error_rows(document))
    turning = tuple(joint.type == "revolute" for joint in arm.joints)
    motions = [
        Comparison(trial.name, trial.role != "evaluate", trial.t, trial.q, q, turning)
        for trial, q in zip(trials, simulated, strict=True)
    ]
    page.picture(angles_figure(motions), "Measured and simulated joint angles: the paper's Fig. 7 and 8 in one.")
    page.picture(error_figure(motions), "Error of each motion.")
    known = compared[0] if compared else None
    of_the_paper = published.ARM in (arm.name, *(c.name for c in compared))
    header = ("parameter", "found", "std", known.name if known else "known", "off by", "paper", "unit")
    for title, part, values, paper in (
        ("Geometry", "kinematics", geometry_by_name(known.arm) if known else {}, published.KINEMATICS),
        ("Dynamics", "dynamics", known.parameters if known else {}, published.DYNAMICS),
    ):
        fields = document.get(part)
        if isinstance(fields, dict):
            page.section(title)
            page.table(header, parameter_rows(fields["parameters"], values, paper if of_the_paper else {}))
    page.write(path)


def _error_rows(document: Document) -> list[tuple[str | float | None, ...]]:
    fields = document["dynamics"]
    assert isinstance(fields, dict)
    rows: list[tuple[str | float | None, ...]] = []
    for role, title in (("learn", "learning"), ("evaluate", "evaluating")):
        found = fields["angle_error_deg"][role]
        if found is not None:
            rows.append((title, found["mean"], found["max"], *published.ANGLE_ERROR_DEG[role]))
    return rows
