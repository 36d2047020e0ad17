"""`fitter track`: accelerations to joint motion."""

import argparse
from pathlib import Path

import numpy as np
from rich.progress import track as progress

from arm.arm_file import load_arm
from fitter.commands.options import (
    MOTION_SUFFIXES,
    add_arm,
    add_columns,
    add_out,
    joint_values,
    make_room,
    per_joint,
    positive,
)
from fitter.motion_file import write_motion
from fitter.raw import load_raw
from fitter.track import Tracked, track_run
from limbcal.command import Document, console, say


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter track` takes."""
    parser.add_argument("raw", nargs="+", type=Path, metavar="RAW", help="raw accelerations: files or folders")
    add_arm(parser)
    parser.add_argument(
        "--method",
        choices=["integrate"],
        default="integrate",
        help="the paper's: moving average of four, double integration",
    )
    parser.add_argument(
        "--zero",
        choices=["each-rest", "first-rest"],
        default="each-rest",
        help="set velocities to zero at each rest, or as the paper does only before the first motion",
    )
    parser.add_argument("--initial-q", metavar="Q1,…", help="where the arm rests at the start (0) [rad or m]")
    parser.add_argument("--frame-rate-hz", type=positive, default=1000.0, metavar="R", help="(1000)")
    add_columns(parser)
    add_out(parser, "joint motion: .csv, .parquet or .npz")
    parser.set_defaults(action=track)


def track(arguments: argparse.Namespace) -> Document:
    """Track all runs and write them into one file."""
    arm = load_arm(arguments.arm)
    names = [sensor.name for sensor in arm.sensors]
    runs = load_raw(arguments.raw, names, arm.n_joint, arguments.columns, rate_hz=arguments.rate_hz)
    q0 = joint_values(arguments.initial_q, arm, "--initial-q", np.zeros(arm.n_joint))
    make_room(arguments.out, MOTION_SUFFIXES)
    tracked: list[Tracked] = []
    for run in progress(runs, "tracking", console=console, transient=True):
        tracked.append(track_run(run, arm, q0, arguments.frame_rate_hz, arguments.zero))
        for note in run.notes:
            say(f"{run.name}: {note}")
    write_motion(arguments.out, _joined(tracked))
    document: dict[str, object] = {
        "method": arguments.method,
        "out": str(arguments.out),
        "frames": sum(part.frames for part in tracked),
        "trials": sum(len(np.unique(part.columns["trial"])) for part in tracked),
        "lost_samples": sum(run.lost for run in runs),
    }
    say(f"{document['frames']} frames in {document['trials']} trial(s) -> {arguments.out}")
    errors = [part.error_deg for part in tracked if part.error_deg is not None]
    if errors:
        error = np.concatenate(errors)
        document["angle_error_deg"] = {"mean": per_joint(error.mean(axis=0)), "max": per_joint(error.max(axis=0))}
        said = ", ".join(f"{mean:.3g} / {top:.3g}" for mean, top in zip(error.mean(0), error.max(0), strict=True))
        say(f"error against the true angles, mean / max a joint [deg]: {said}")
    return document


def _joined(tracked: list[Tracked]) -> dict[str, np.ndarray[tuple[int, ...], np.dtype[np.generic]]]:
    """Lay runs one after the other; their trials keep apart."""
    if len(tracked) == 1:
        return tracked[0].columns
    shared = [name for name in tracked[0].columns if all(name in part.columns for part in tracked)]
    joined = {name: np.concatenate([part.columns[name] for part in tracked]) for name in shared}
    labels = [[f"{k + 1}.{label}" for label in part.columns["trial"]] for k, part in enumerate(tracked)]
    joined["trial"] = np.concatenate([np.array(part, dtype=np.str_) for part in labels])
    return joined
