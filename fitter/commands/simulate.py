"""`fitter simulate`: the motion of a calibrated arm under its control, section 7."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from arm.possible import why_it_runs_away
from arm.simulation import tip_of
from arm.trial_simulation import simulate_trial
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import MOTION_SUFFIXES, add_arm, add_columns, add_out, joint_values, make_room
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
    make_room(arguments.out, MOTION_SUFFIXES, [arguments.reference])
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
        motion = simulate_trial(arm, trial.measured.columns, trial.dt_s, q0, arguments.scheme, *place)
        if not np.isfinite(motion.q).all():
            raise DataError(f"{measured.name}: the simulation runs away to infinity: {why_it_runs_away(arm)}")
        columns = {name: getattr(motion, name) for name in ("q", "dq", "ddq", "tau", "ref")}
        parts.append(
            {
                "t": motion.t + measured.t[0],
                **columns,
                "tip": tip_of(arm, motion),
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
