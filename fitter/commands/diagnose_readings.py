"""`fitter diagnose` of raw accelerations: whether the sensors contradict a rigid arm, and which of them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from arm.arm_file import save_arm
from arm.effects.catalogue import catalogue
from arm.model import Arm
from fitter.data.plausibility.refusal import Refusal
from fitter.data.raw import RawRun, load_raw
from fitter.diagnosis.finding import UNKNOWN, UNKNOWN_ERRORS, UNKNOWN_RESIDUAL
from fitter.reading_diagnosis.rigidity import diagnose_sensors
from fitter.reading_diagnosis.sensor_verdict import SensorCause, SensorFinding
from limbcal.command import Document, console, show, to_json, with_asked
from limbcal.digits import with_interval
from limbcal.errors import DataError, DeviceError
from protocol.tables.files import RECORDINGS, expand

_SENTENCES = {
    "named": "The sensors contradict a rigid arm, and this is why:",
    "ambiguous": "The sensors contradict a rigid arm; these explain it equally well:",
    "none": "The sensors agree with a rigid arm: nothing above the noise.",
    "unexplained": "The sensors contradict a rigid arm, and no effect of the catalogue explains it.",
}


def readings(sources: Sequence[Path], arm: Arm, columns: str | None, rate_hz: float | None) -> list[RawRun] | None:
    """Return raw accelerations, or None where the files hold joint motion."""
    if not arm.sensors or any(path.suffix.lower() in RECORDINGS for path in expand(sources)):
        return None
    try:
        names = [sensor.name for sensor in arm.sensors]
        return load_raw(sources, names, arm.n_joint, columns, rate_hz=rate_hz, arm=arm)
    except Refusal:
        raise
    except DataError:
        return None  # then it is joint motion, and what is wrong with that will be said


def diagnose_readings(arm: Arm, learn: Sequence[RawRun], evaluate: Sequence[RawRun], out: Path) -> Document:
    """Diagnose the sensors, write everything, and say it.

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        progress.add_task("comparing the sensors with a rigid arm", total=None)
        finding = diagnose_sensors(arm, learn, evaluate)
    answer = with_asked({**document(finding), "notes": []})
    try:
        (out / "diagnosis.json").write_text(to_json(answer), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{out}: cannot be written: {error.strerror}") from error
    save_arm(finding.arm, out / "extended.toml")
    from fitter.report.sensor_diagnosis import write_sensor_report

    write_sensor_report(finding, [described(cause) for cause in finding.causes], _SENTENCES[finding.verdict], out)
    show(_SENTENCES[finding.verdict])
    for cause in finding.causes:
        show(f"  {described(cause)}")
    show(_contradictions(finding))
    show(f"next: {finding.next_experiment}")
    show(f"report: {out / 'report.html'}")
    return answer


def _contradictions(finding: SensorFinding) -> Table:
    table = Table(escape("contradiction, rms [m/s^2]"), "before", "after")
    for name, was in finding.before.items():
        table.add_row(Text(name), f"{was:.4g}", f"{finding.after[name]:.4g}")
    return table


def document(finding: SensorFinding) -> Document:
    """Return the JSON document; torque and angle are not known from accelerations alone."""
    before, after = (float(np.linalg.norm(list(rms.values()))) for rms in (finding.before, finding.after))
    share = after / before if before > 0.0 else 0.0
    left = {"torque_rms_N_m": None, "share": share, "times_noise": finding.times_noise}
    return UNKNOWN | {
        "verdict": finding.verdict,
        "complete": bool(finding.residual.white),
        "left": left | {"reading_rms_m_s2": dict(finding.after)},
        "causes": [
            {
                "effect": cause.effect,
                "sensors": list(cause.sensors),
                "parameters": {
                    name: {"value": p.value, "std": p.std, "unit": p.unit} for name, p in cause.parameters.items()
                },
                "support": cause.support,
            }
            for cause in finding.causes
        ],
        "candidates": [
            {"effect": one.effect, "sensors": list(one.sensors), "gain": one.gain, "support": one.support}
            for one in finding.candidates
        ],
        "confusable": [list(pair) for pair in finding.confusable],
        "next_experiment": finding.next_experiment,
        "before": UNKNOWN_ERRORS | {"reading_rms_m_s2": dict(finding.before)},
        "after": UNKNOWN_ERRORS | {"reading_rms_m_s2": dict(finding.after)},
        "gain": {"torque": None, "angle": None, "readings": finding.gain, "ci95": None},
        "structure": {"beyond_noise": finding.beyond_noise},
        "residual": UNKNOWN_RESIDUAL
        | {
            "explained": finding.residual.explained,
            "white": finding.residual.white,
            "depends_on": list(finding.residual.depends_on),
        },
    }


def described(cause: SensorCause) -> str:
    """Return a cause in plain words, with its size."""
    where = "".join(f", {name}" for name in cause.sensors)
    numbers = ", ".join(f"{name} {with_interval(p.value, p.std)} {p.unit}" for name, p in cause.parameters.items())
    return f"{cause.effect}{where}: {catalogue()[cause.effect].sentence} ({numbers})"
