"""What `fitter subscribe --diagnose` does at the end: why the calibrated simulation is wrong."""

import json
from collections.abc import Sequence
from pathlib import Path

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.trials import Trial
from fitter.diagnosis.diagnosis import Diagnosis, diagnose
from fitter.dynamics.learned_torque import target_of
from fitter.live.calibration import Calibration
from fitter.report.diagnosis_report import write_diagnosis
from limbcal.command import Document, say, show, to_json
from limbcal.errors import DataError, DeviceError, LimbcalError
from limbcal.note import Note

#: Fewer motions tell nothing: something is to be learnt, and something held back to judge on.
_LEAST = 2
#: What is white in the noise of tracked angles is hardly anything; their slow errors look like torque.
_HINT = "angles were tracked and targets found with the arm: their slow errors can pass for causes, a hint only"


def live_diagnosis(calibration: Calibration) -> Diagnosis | None:
    """Diagnose a calibration that has come to its end; say why where that cannot be done.

    A diagnosis that fails takes nothing away from what was learnt.
    """
    say("diagnosing; Ctrl-C leaves it out")
    try:
        found = _diagnosed(calibration)
    except KeyboardInterrupt:
        say("the diagnosis is left out: stopped")
        return None
    except LimbcalError as error:
        say(f"the diagnosis is left out: {error}")
        return None
    effects = ", ".join(cause.effect for cause in found.finding.causes)
    show(f"diagnosis: {found.finding.verdict}{f' ({effects})' if effects else ''}; {_HINT}")
    return found


def diagnosis_fields(found: Diagnosis) -> Document:
    """Return the fields of `limb/diagnosis`: those of ``diagnosis.json``, nil for what is not a number."""
    fields: Document = json.loads(to_json(found.finding.document()))
    return fields


def write_live_diagnosis(found: Diagnosis, out: Path) -> None:
    """Write a diagnosis into a folder of its own, beside the calibration's report.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    folder = out / "diagnosis"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DeviceError(f"{folder}: cannot be made a directory: {error.strerror}") from error
    write_diagnosis(found, folder)
    show(f"diagnosis: {folder / 'report.html'}")


def _diagnosed(calibration: Calibration) -> Diagnosis:
    if calibration.dynamics is None:
        raise DataError(f"the dynamics were not learnt{f': {calibration.doubt}' if calibration.doubt else ''}")
    learn, evaluate = parted(calibration.learn, calibration.evaluate)
    arm = calibration.calibrated()
    return diagnose(arm, [_measured(arm, trial) for trial in learn], [_measured(arm, trial) for trial in evaluate])


def parted(learn: Sequence[Trial], evaluate: Sequence[Trial]) -> tuple[list[Trial], list[Trial]]:
    """Return what to learn from and what to judge on: by role, or halves where all have the same.

    Raises
    ------
    DataError
        If there is but one motion.
    """
    if learn and evaluate:
        return list(learn), list(evaluate)
    trials = [*learn, *evaluate]
    if len(trials) < _LEAST:
        raise DataError(f"{len(trials)} motion(s), expected at least {_LEAST}: what is learnt from cannot judge")
    half = -(-len(trials) // 2)
    return trials[:half], trials[half:]


def _measured(arm: Arm, trial: Trial) -> Measured:
    """Return a motion as a file would have it: angles, and the target that the calibrated arm explains it with."""
    columns = {"q": trial.q}
    if trial.tau is not None:
        columns["tau"] = trial.tau
    elif arm.control.law != "measured":
        columns["ref"] = target_of(arm, trial)
    notes = (*trial.notes, Note("hint", _HINT))
    return Measured(trial.name, "stream", 0, trial.t, columns, role=trial.role, notes=notes)
