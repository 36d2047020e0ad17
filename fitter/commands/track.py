"""`fitter track`: accelerations, or markers, to joint motion."""

import argparse
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.progress import track as progress

from arm.model import Arm
from fitter.commands.arm_option import questioned_arm
from fitter.commands.limb_export import add_export
from fitter.commands.limb_track import has_markers, limb_track
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
from fitter.data.motion_file import write_motion
from fitter.data.raw import RawRun, load_raw
from fitter.data.sensor_files import gyro_axes
from fitter.sensing.track import Tracked, track_run
from fitter.sensing.verdict import overall
from limbcal.command import Document, console, say, say_notes, show
from limbcal.errors import ConfigError
from limbcal.note import Note, documents, of_source

#: As it stands in the help.
EXAMPLE = "fitter track readings.csv --arm my-arm.toml --out motion.csv"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter track` takes."""
    parser.add_argument(
        "raw", nargs="+", type=Path, metavar="RAW", help="raw accelerations: files or folders; or C3D, TRC"
    )
    add_arm(parser)
    parser.add_argument(
        "--method",
        choices=["integrate", "filter", "smooth"],
        default="smooth",
        help="the paper's double integration; a Kalman filter, as live; or a smoother, for which every reading "
        "counts at every instant (smooth)",
    )
    parser.add_argument(
        "--zero",
        choices=["each-rest", "first-rest"],
        help="with --method integrate: set velocities to zero at each rest (each-rest), or as the paper does only "
        "before the first motion",
    )
    parser.add_argument(
        "--initial-q",
        metavar="Q1,…",
        help="where the arm is at the start [rad or m] (as gravity shows, or 0; with integrate 0)",
    )
    parser.add_argument("--frame-rate-hz", type=positive, default=1000.0, metavar="R", help="(1000)")
    add_columns(parser)
    add_out(parser, "joint motion: .csv, .parquet or .npz")
    add_export(parser, motions=True)
    parser.set_defaults(action=track)


def track(arguments: argparse.Namespace) -> Document:
    """Track all runs and write them into one file."""
    if has_markers(arguments.raw):
        return limb_track(arguments)
    if arguments.export:
        raise ConfigError("--export is given, expected it only with recordings of markers (C3D, TRC)")
    method, zero = arguments.method, arguments.zero
    if zero is not None and method != "integrate":
        raise ConfigError(f"--zero is {zero!r}, expected it only with --method integrate, not {method}")
    arm = questioned_arm(arguments.arm)
    names = [sensor.name for sensor in arm.sensors]
    runs = load_raw(arguments.raw, names, arm.n_joint, arguments.columns, rate_hz=arguments.rate_hz, arm=arm)
    given = arguments.initial_q
    q0 = None if given is None else joint_values(given, arm, "--initial-q")
    make_room(arguments.out, MOTION_SUFFIXES, arguments.raw)
    tracked: list[Tracked] = []
    began = time.perf_counter()
    for run in progress(runs, "tracking", console=console, transient=True):
        # where the clock leapt the arm did not: it is where it was
        start = tracked[-1].last_q if run.after_leap else q0
        tracked.append(track_run(run, arm, start, arguments.frame_rate_hz, method, zero or "each-rest"))
    seconds = time.perf_counter() - began
    notes = [
        note
        for run, part in zip(runs, tracked, strict=True)
        for note in of_source((*run.notes, *part.notes), run.name)
    ]
    if method == "integrate" and (aside := sorted({name for run in runs for name in run.gyros})):
        text = f"double integration has no use for gyroscopes: those of {', '.join(aside)} are left aside"
        notes.append(Note("unused", text, columns=tuple(axis for name in aside for axis in gyro_axes(name))))
    say_notes(notes)
    write_motion(arguments.out, _joined(tracked))
    document: dict[str, object] = {
        "method": method,
        "out": str(arguments.out),
        "frames": sum(part.frames for part in tracked),
        "trials": sum(len(np.unique(part.columns["trial"])) for part in tracked),
        "lost_samples": sum(run.lost for run in runs),
        "seconds": seconds,
        **overall([part.verdict for part in tracked], [part.frames for part in tracked]),
        "notes": documents(notes),
    }
    show(f"{document['frames']} frames in {document['trials']} trial(s) -> {arguments.out}")
    for run, part in zip(runs, tracked, strict=True):
        _warn(run, arm, part)
    return document | _against_truth(tracked, arm)


def _warn(run: RawRun, arm: Arm, part: Tracked) -> None:
    """Say what to do where a tracker does not believe its readings."""
    verdict = part.verdict
    if run.after_leap and (verdict.wrong or verdict.converged is False):
        say(
            f"warning: {run.name}: it begins where time leapt, and the arm may have moved meanwhile: do not rely "
            "on its angles; expected a recording of its own that begins at rest"
        )
    elif verdict.discrepancy_m_s2 is not None:
        rate = f" and {verdict.discrepancy_rad_s:.2g} rad/s" if verdict.discrepancy_rad_s else ""
        base = f", and its base moves by {verdict.base_m_s2:.2g} m/s^2" if verdict.base_m_s2 else ""
        say(
            f"warning: {run.name}: the readings differ from arm {arm.name!r} by {verdict.discrepancy_m_s2:.2g} "
            f"m/s^2{rate} rms beyond the sensors' noise{base}; q_std allows for that. If its lengths or its "
            "sensors may be other than its file says, let `fitter sensors` find how they are"
        )
    elif verdict.place_off_m is not None and verdict.turn_off_rad is not None:
        off = f"{100.0 * verdict.place_off_m:.2g} cm and {np.rad2deg(verdict.turn_off_rad):.2g} deg"
        say(
            f"warning: {run.name}: the readings fit arm {arm.name!r} only if its sensors sit otherwise than its "
            f"file says, by up to {off}; the motion allows for that; let `fitter sensors` find how they do, and "
            "track with what it writes"
        )
    elif verdict.wrong:
        share = f"{100 * (verdict.doubted or 0.0):.2g} % of the frames fit no motion of it"
        size = verdict.innovation
        missed = "" if size is None else f", the mean squared misprediction is {size:.2g}"
        say(
            f"warning: {run.name}: the readings contradict arm {arm.name!r} ({share}{missed}); check its lengths "
            "and where its sensors sit, or let `fitter sensors` find how they do"
        )
    if verdict.late_s is not None:
        say(
            f"warning: {run.name}: a sensor's clock is {1e3 * abs(verdict.late_s):.2g} ms "
            f"{'late' if verdict.late_s > 0.0 else 'early'} against the first sensor's; the motion allows for that"
        )
    if not run.after_leap and verdict.converged is False:
        # what the model lacks is learnt beginning with what gravity shows, whatever angles were given
        start = ", or say by --initial-q where it rests at the start" if verdict.discrepancy_m_s2 is None else ""
        say(
            f"warning: {run.name}: after {verdict.passes} passes the motion still changes; check the arm's "
            f"lengths{start}"
        )


def _against_truth(tracked: list[Tracked], arm: Arm) -> dict[str, object]:
    """Say how far the angles are from the true ones, and whether by no more than they claim."""
    errors = [part.error_deg for part in tracked if part.error_deg is not None]
    if not errors:
        return {}
    error = np.concatenate(errors)
    found: dict[str, object] = {
        "angle_error_deg": {"mean": per_joint(error.mean(axis=0)), "max": per_joint(error.max(axis=0))}
    }
    units = ["deg" if joint.type == "revolute" else "mm" for joint in arm.joints]
    each = zip(error.mean(0), error.max(0), units, strict=True)
    said = ", ".join(f"{mean:.3g} / {top:.3g} {unit}" for mean, top, unit in each)
    show(f"error against the true angles, mean / max a joint: {said}")
    claims = [part.within_3_std for part in tracked if part.within_3_std is not None]
    if claims:
        share = np.concatenate(claims).mean(axis=0)
        found["within_3_std"] = per_joint(share)
        show("of it within 3 of its own standard errors: " + ", ".join(f"{100 * part:.4g} %" for part in share))
    return found


def _joined(tracked: list[Tracked]) -> dict[str, NDArray[np.generic]]:
    """Lay runs one after the other; where two runs call a trial alike, all say of which run theirs are."""
    if len(tracked) == 1:
        return tracked[0].columns
    tables = [part.columns for part in tracked]
    if any("gap" in table for table in tables):
        tables = [{"gap": np.zeros(len(table["t"]), dtype=np.int64), **table} for table in tables]
    shared = [name for name in tracked[0].columns | tables[0] if all(name in table for table in tables)]
    joined = {name: np.concatenate([table[name] for table in tables]) for name in shared}
    labels = [table["trial"].astype(np.str_) for table in tables]
    own = [set(part.tolist()) for part in labels]
    if sum(map(len, own)) > len(set.union(*own)):
        labels = [np.array([f"{k}.{label}" for label in part]) for k, part in enumerate(labels, 1)]
    joined["trial"] = np.concatenate(labels)
    return joined
