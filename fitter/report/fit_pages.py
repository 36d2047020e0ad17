"""The pages of `fitter dynamics --report` and `fitter kinematics --report`."""

from collections.abc import Mapping, Sequence

from fitter.data.torque_target import has_unknown_target
from fitter.data.trial import Trial, is_driven
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.evaluation import motion_error
from fitter.kinematics.kinematics_fit import KinematicsFit
from fitter.report import published
from fitter.report.assumptions import dynamics_assumptions, kinematics_assumptions
from fitter.report.calibration_page import CalibrationPage, Section, error_rows
from fitter.report.figures import Comparison
from fitter.report.provenance import provenance
from limbcal.note import Note, of_source


def dynamics_page(
    fit: DynamicsFit,
    answer: Mapping[str, object],
    learn: Sequence[Trial],
    evaluate: Sequence[Trial],
    others: Mapping[str, Mapping[str, float]],
    files: Sequence[object],
    horizon_s: float,
    alarms: Sequence[str] = (),
) -> CalibrationPage:
    """Return the page of a fit of the dynamics.

    Parameters
    ----------
    fit : DynamicsFit
    answer : mapping
        Its JSON document, with the errors of both sets of trials.
    learn, evaluate : sequence of Trial
    others : mapping from an arm's name to its values by the parameters' names
    files : sequence of path
        What was read.
    horizon_s : float
        Where torque was measured, simulations begin anew after this time [s].
    alarms : sequence of str
        Why the answer is not to be used.
    """
    turning = tuple(joint.type == "revolute" for joint in fit.arm.joints)
    of_the_paper = published.ARM in (fit.arm.name, *others)
    columns = {**others, "the paper": published.DYNAMICS} if of_the_paper else others
    motions = [
        Comparison(
            trial.name, learnt, trial.t, trial.q, trial.q + motion_error(fit.arm, trial, horizon_s), turning
        )
        for learnt, trials in ((True, learn), (False, evaluate))
        for trial in trials
    ]
    found = any(has_unknown_target(fit.arm, trial) for trial in (*learn, *evaluate))
    return CalibrationPage(
        arm=fit.arm,
        lead=_lead(learn, evaluate, fit.samples),
        sections=[Section("Dynamics", fit.parameters, columns)],
        errors=error_rows(answer, None),
        assumptions=dynamics_assumptions(
            fit.arm, lengths_learnt=False, targets_found=found, driven=is_driven(learn)
        ),
        notes=[*_notes(learn, evaluate), *(note for note in fit.notes if note.kind != "assumed")],
        provenance=provenance(files),
        motions=motions,
        alarms=alarms,
        of_the_paper=of_the_paper,
    )


def kinematics_page(
    fit: KinematicsFit,
    answer: Mapping[str, object],
    learn: Sequence[Trial],
    evaluate: Sequence[Trial],
    others: Mapping[str, Mapping[str, float]],
    files: Sequence[object],
) -> CalibrationPage:
    """Return the page of a fit of the geometry; parameters as for `dynamics_page`."""
    of_the_paper = published.ARM in (fit.arm.name, *others)
    columns = {**others, "the paper": published.KINEMATICS} if of_the_paper else others
    return CalibrationPage(
        arm=fit.arm,
        lead=_lead(learn, evaluate, fit.samples),
        sections=[Section("Geometry", fit.parameters, columns)],
        errors=error_rows(None, answer),
        assumptions=kinematics_assumptions(fit.arm),
        notes=[*_notes(learn, evaluate), *fit.notes],
        provenance=provenance(files),
    )


def _lead(learn: Sequence[Trial], evaluate: Sequence[Trial], samples: int) -> str:
    return f"{len(learn)} trials ({samples} samples) learnt from, {len(evaluate)} held back to evaluate."


def _notes(learn: Sequence[Trial], evaluate: Sequence[Trial]) -> list[Note]:
    return [note for trial in (*learn, *evaluate) for note in of_source(trial.notes, trial.name)]
