"""What `fitter subscribe --diagnose` does at the end: why the calibrated simulation is wrong."""

import json
from collections.abc import Sequence
from pathlib import Path

from fitter.data.trial import Trial
from fitter.diagnosis.diagnosis import Diagnosis, diagnose
from fitter.dynamics.found_targets import HINT, with_target
from fitter.live.calibration import Calibration
from limbcal.command import Document, say, show, to_json
from limbcal.errors import DataError, DeviceError, LimbcalError

#: Fewer motions are not enough: some are learnt from, and some are held back to judge on.
_LEAST = 2


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
    show(f"diagnosis: {found.finding.verdict}{f' ({effects})' if effects else ''}; {HINT}")
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
    from fitter.report.diagnosis_report import write_diagnosis

    write_diagnosis(found, folder)
    show(f"diagnosis: {folder / 'report.html'}")


def _diagnosed(calibration: Calibration) -> Diagnosis:
    if calibration.dynamics is None:
        raise DataError(f"the dynamics were not learnt{f': {calibration.doubt}' if calibration.doubt else ''}")
    learn, evaluate = parted(calibration.learn, calibration.evaluate)
    arm = calibration.calibrated()
    learning, judging = ([with_target(arm, trial) for trial in trials] for trials in (learn, evaluate))
    return diagnose(arm, learning, judging)


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
