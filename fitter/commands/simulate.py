"""`fitter simulate`: the motion of a calibrated arm under its control, section 7."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.effects.trials import TrialId
from arm.model import Arm, Floats
from arm.possible import why_it_runs_away
from arm.simulation import Motion, simulate, tip_of
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import MOTION_SUFFIXES, add_arm, add_columns, add_out, joint_values, make_room
from fitter.data.drives import drives_of
from fitter.data.leaps import split_at_leaps
from fitter.data.motion_file import write_motion
from fitter.data.motions import Measured, read_motions, trial_column
from fitter.data.plausibility.reference import look
from fitter.data.resample import resample
from limbcal.command import Document, say_notes, show
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note, documents, of_source
from protocol.tables.columns import parse_mapping
from protocol.tables.stamps import require_seconds

#: The simulation's own step is at most this long [s].
_LONGEST_STEP_S = 1e-3

#: As it stands in the help.
EXAMPLE = "fitter simulate --arm calibrated.toml --reference reference.csv --out motion.csv"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter simulate` takes."""
    add_arm(parser)
    parser.add_argument(
        "--reference",
        type=Path,
        required=True,
        metavar="FILE",
        help="t, ref1… (or tau1… where the arm's law is 'measured'), and where known q1…, dq1…, on1…, kp1…, kv1…, "
        "trial",
    )
    parser.add_argument("--initial-q", metavar="Q1,…", help="state at the start of each trial [rad or m]")
    parser.add_argument(
        "--scheme",
        choices=["rk4", "paper"],
        default="rk4",
        help="integration: Runge-Kutta, or as the paper prints it",
    )
    add_columns(parser)
    add_out(parser, "joint motion: .csv, .parquet or .npz")
    parser.set_defaults(action=simulate_reference)


def simulate_reference(arguments: argparse.Namespace) -> Document:
    """Simulate every trial of a reference and write the motion."""
    arm = questioned_arm(arguments.arm)
    role = "tau" if arm.control.law == "measured" else "ref"
    mapping = parse_mapping(arguments.columns, arm.n_joint)
    read = read_motions(arguments.reference, arm.n_joint, mapping, arguments.rate_hz, required=(role,))
    trials = [piece for motion in read for piece in split_at_leaps(look(motion, arm))]
    make_room(arguments.out, MOTION_SUFFIXES)
    parts: list[dict[str, NDArray[np.generic]]] = []
    notes: list[Note] = []
    labels = trial_column(trials)
    for number, measured in enumerate(trials, 1):
        require_seconds(measured.t, measured.where)
        trial = resample(measured, arguments.rate_hz)
        notes += of_source(trial.measured.notes, measured.name)
        given = arguments.initial_q
        q0 = _start(trial.measured, arm) if given is None else joint_values(given, arm, "--initial-q")
        place = float(measured.t[0]), measured.identity(number)
        motion, tip = _simulated(arm, trial.measured, trial.dt_s, q0, arguments.scheme, *place)
        if not np.isfinite(motion.q).all():
            raise DataError(f"{measured.name}: the simulation runs away to infinity: {why_it_runs_away(arm)}")
        columns = {name: getattr(motion, name) for name in ("q", "dq", "ddq", "tau", "ref")}
        parts.append(
            {
                "t": motion.t + measured.t[0],
                **columns,
                "tip": tip,
                "trial": np.full(len(motion.t), labels[number - 1]),
            }
        )
    write_motion(arguments.out, {name: np.concatenate([part[name] for part in parts]) for name in parts[0]})
    samples = sum(len(part["t"]) for part in parts)
    say_notes(notes)
    show(f"{len(parts)} trial(s), {samples} samples -> {arguments.out}")
    return {
        "out": str(arguments.out),
        "trials": len(parts),
        "samples": samples,
        "scheme": arguments.scheme,
        "notes": documents(notes),
    }


def _start(measured: Measured, arm: Arm) -> Floats:
    """Return the state that the file begins with: its own angles, or at rest at the target."""
    for role in ("q", "ref"):
        if role in measured.columns:
            start: Floats = measured.columns[role][0]
            return start
    raise ConfigError(
        f"{measured.where}: has no q1… to start from, expected them or --initial-q for arm {arm.name}"
    )


def _simulated(
    arm: Arm, trial: Measured, dt_s: float, q0: Floats, scheme: str, t0_s: float, identity: TrialId
) -> tuple[Motion, Floats]:
    """Simulate with steps that are short enough, and give back the file's own samples and where the tip was."""
    parts = max(1, int(np.ceil(dt_s / _LONGEST_STEP_S - 1e-9)))
    n = len(trial.t)
    held = np.repeat(np.arange(n), parts)
    torque = None
    if arm.control.law == "measured":
        fine = np.arange(n * parts) / parts
        tau = trial.columns["tau"]
        torque = np.column_stack([np.interp(fine, np.arange(n), column) for column in tau.T])
    ref = trial.columns.get("ref", np.zeros((n, arm.n_joint)))[held]
    dq, drives = trial.columns.get("dq"), drives_of(trial.columns)
    motion = simulate(
        arm,
        ref,
        dt_s / parts,
        q0,
        None if dq is None else dq[0],
        "paper" if scheme == "paper" else "rk4",
        torque,
        t0_s,
        identity,
        None if drives is None else drives.rows(held),
    )
    own = Motion(*(getattr(motion, name)[::parts] for name in ("t", "q", "dq", "ddq", "tau", "ref")))
    return own, tip_of(arm, motion)[::parts]
