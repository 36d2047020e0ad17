"""`fitter excite`: a reference that reveals an arm's dynamic parameters, within what the arm may do."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress
from rich.table import Table

from arm.bench import Bench
from arm.model import Arm, Floats
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import (
    MOTION_SUFFIXES,
    add_arm,
    add_out,
    add_search,
    at_least,
    joint_values,
    make_room,
    positive,
)
from fitter.data.motion_file import write_motion
from fitter.excitation.driven import Limits
from fitter.excitation.information import NOISE
from fitter.excitation.suggestion import GENERATIONS, POPULATION, Suggestion, suggest
from limbcal.command import Document, console, show
from limbcal.errors import ConfigError

#: As it stands in the help.
EXAMPLE = "fitter excite --arm my-arm.toml --out reference.csv"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter excite` takes."""
    add_arm(parser)
    parser.add_argument("--kind", choices=["fourier", "points"], default="fourier", help="shape of a trial")
    parser.add_argument("--trials", type=at_least(1), default=Bench.learning, metavar="N")
    parser.add_argument("--seconds", type=positive, default=Bench.trial_s, metavar="S", help="of each trial")
    parser.add_argument("--rate-hz", type=positive, default=1000.0, metavar="R", help="of the reference (1000)")
    limit = "one number, or one a joint"
    parser.add_argument("--max-angle-deg", metavar="A,…", help=f"{limit}; m where it slides (as random motion)")
    parser.add_argument("--max-speed", metavar="V,…", help=f"{limit} [rad/s or m/s] (as random motion)")
    parser.add_argument("--max-torque", metavar="T,…", help=f"{limit} [N m or N] (as random motion)")
    parser.add_argument("--reveal", metavar="P,…", help="base parameters that are wanted (all)")
    add_search(parser, f"{POPULATION}, or 2 a gene", GENERATIONS)
    add_out(parser, "the reference: .csv, .parquet or .npz")
    parser.set_defaults(action=excite)


def excite(arguments: argparse.Namespace) -> Document:
    """Search for a reference and write it."""
    arm = questioned_arm(arguments.arm)
    make_room(arguments.out, MOTION_SUFFIXES)
    turns = np.array([joint.type == "revolute" for joint in arm.joints])
    angle = _limit(arguments.max_angle_deg, arm, "--max-angle-deg")
    reveal = [] if arguments.reveal is None else [name.strip() for name in arguments.reveal.split(",")]
    bench = Bench(rate_hz=arguments.rate_hz, trial_s=arguments.seconds, learning=arguments.trials, evaluating=0)
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("searching", total=arguments.trials * arguments.generations)
        found = suggest(
            arm,
            arguments.kind,
            bench,
            seed=arguments.seed,
            angle=None if angle is None else np.where(turns, np.deg2rad(angle), angle),
            speed=_limit(arguments.max_speed, arm, "--max-speed"),
            torque=_limit(arguments.max_torque, arm, "--max-torque"),
            reveal=reveal,
            population=arguments.population or POPULATION,
            generations=arguments.generations,
            progress=lambda: bar.advance(task),
        )
    _write(arguments.out, found, bench, arm.control.law == "measured")
    _print(found, turns)
    given = {
        name: getattr(arguments, option) is not None
        for name, option in (("angle_deg", "max_angle_deg"), ("speed", "max_speed"), ("torque", "max_torque"))
    }
    return {
        "out": str(arguments.out),
        "arm": arm.name,
        "kind": arguments.kind,
        "law": arm.control.law,
        "trials": bench.learning,
        "seconds": bench.trial_s,
        "rate_hz": bench.rate_hz,
        "samples": sum(len(motion.t) for motion in found.motions),
        "torque_noise": {"share": NOISE, "std": found.noise},
        "condition_number": {
            "suggested": found.suggested.condition_number,
            "random": found.random.condition_number,
        },
        "relative_std": _relative(found),
        "limits": {**_document(found.limits, turns), "given": given},
        "reached": _document(found.reached, turns),
    }


def _limit(text: str | None, arm: Arm, option: str) -> Floats | None:
    """Read one positive number for all joints, or one for each."""
    if text is None:
        return None
    values = joint_values(text if "," in text else ",".join([text] * arm.n_joint), arm, option)
    if not np.all(values > 0.0):
        raise ConfigError(f"{option} is {text!r}, expected numbers above 0")
    return values


def _write(out: Path, found: Suggestion, bench: Bench, measured: bool) -> None:
    """Write the reference, and where each trial is predicted to be: `fitter simulate` starts from there."""
    counts = [len(motion.t) for motion in found.motions]
    columns = {
        "t": np.concatenate([motion.t + k * bench.trial_s for k, motion in enumerate(found.motions)]),
        "ref": np.concatenate([motion.ref for motion in found.motions]),
        "q": np.concatenate([motion.q for motion in found.motions]),
    }
    if measured:  # what drives a simulation where no law does
        columns |= {name: np.concatenate([getattr(m, name) for m in found.motions]) for name in ("dq", "tau")}
    write_motion(out, columns | {"trial": np.repeat(np.arange(1, len(counts) + 1), counts)})


def _relative(found: Suggestion) -> dict[str, dict[str, float | None]]:
    """Return predicted standard errors as shares of the arm file's values; None where a value is zero."""
    shares = {}
    for k, name in enumerate(found.base.names):
        size = abs(float(found.values[k]))
        pair = {"suggested": found.suggested.std[k], "random": found.random.std[k]}
        shares[name] = {which: float(std) / size if size > 0.0 else None for which, std in pair.items()}
    return shares


def _document(limits: Limits, turns: Floats) -> dict[str, object]:
    angle = np.where(turns, np.rad2deg(limits.angle), limits.angle)
    return {"angle_deg": angle, "speed": limits.speed, "torque": limits.torque}


def _print(found: Suggestion, turns: NDArray[np.bool_]) -> None:
    table = Table(title=f"predicted standard errors, {NOISE:.0%} noise of the torque")
    for column in ("parameter", "arm file", "suggested", "random"):
        table.add_column(column, justify="left" if column == "parameter" else "right")
    for k, name in enumerate(found.base.names):
        table.add_row(
            name, f"{found.values[k]:.4g}", f"{found.suggested.std[k]:.2g}", f"{found.random.std[k]:.2g}"
        )
    show(table)
    show(
        f"condition {found.suggested.condition_number:.3g}, of random motion {found.random.condition_number:.3g}; "
        f"reaches {_reached(found.reached, turns)}, of at most {_reached(found.limits, turns)}"
    )


def _reached(limits: Limits, turns: NDArray[np.bool_]) -> str:
    """Say angles, speeds and torques, or where joints slide ways and forces; a unit once if it is that of all."""
    angle = np.where(turns, np.rad2deg(limits.angle), limits.angle)
    columns = ((angle, "°", " m"), (limits.speed, " rad/s", " m/s"), (limits.torque, " N·m", " N"))
    said = []
    for values, turning, sliding in columns:
        units = [turning if turn else sliding for turn in turns]
        shown = [unit if after != unit else "" for unit, after in zip(units, [*units[1:], ""], strict=True)]
        said.append(", ".join(f"{value:.3g}{unit}" for value, unit in zip(values, shown, strict=True)))
    return ", ".join(said)
