"""`fitter torque`: the joint torques that an arm needs for a motion, inverse dynamics on a base that may move."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import track as progress

from arm.base_pose import gravity_in_world, is_carried
from arm.effects.effect_table import changed
from arm.effects.resisting_torque import resisting_torque
from arm.effects.trials import AnyTrial, TrialId
from arm.model import Arm, Floats
from arm.moving_base import BaseState, OuterWrench, carried_inverse_dynamics
from fitter.commands.arm_option import questioned_arm
from fitter.commands.options import MOTION_SUFFIXES, add_arm, add_columns, add_out, make_room, per_joint
from fitter.data.base_columns import base_state, derivatives
from fitter.data.motion_file import write_motion
from fitter.data.motions import TIP, Measured, read_motions, trial_column
from fitter.data.plausibility.questions import questioned
from fitter.data.resample import split_at_holes
from fitter.ground.force_plausibility import far, light, pulling, unknown
from fitter.ground.link_names import link_named, link_names, segments
from fitter.ground.placed_plates import ends, placed
from limbcal.command import Document, console, say_notes, show
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note, documents, of_source
from protocol.markers.wrench_files import PlateWrench, read_wrenches
from protocol.tables.columns import BASE_ROLES, parse_mapping
from protocol.tables.stamps import require_seconds

#: As it stands in the help.
EXAMPLE = "fitter torque motion.csv --arm my-arm.toml --out torque.csv"
#: Passes until effects that depend on the torque itself, such as friction under load, agree with it.
_PASSES = 20
_AGREED_N_M = 1e-10
#: What a trial's torques are made of.
_MOTION = ("q", "dq", "ddq", "base")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter torque` takes."""
    parser.add_argument(
        "motion", nargs="+", type=Path, metavar="MOTION", help="t, q1… and where known dq1…, base_x…"
    )
    add_arm(parser)
    parser.add_argument(
        "--ground",
        nargs="+",
        type=Path,
        default=[],
        metavar="FORCES",
        help="one C3D, MOT or STO a trial, in order",
    )
    parser.add_argument(
        "--contact",
        action="append",
        default=[],
        metavar="PLATE=LINK",
        help="on which link a plate's force acts: its name or number, and the joint's number or the person's "
        "segment, such as foot_right (by its place; on a chain the only loaded plate is on the last link)",
    )
    add_columns(parser)
    add_out(parser, "the motion with tau1…: .csv, .parquet or .npz")
    parser.set_defaults(action=torque)


def torque(arguments: argparse.Namespace) -> Document:
    """Compute the torques of all trials and write them on the motion's own times."""
    arm = questioned_arm(arguments.arm)
    make_room(arguments.out, MOTION_SUFFIXES, [*arguments.motion, *arguments.ground])
    mapping = parse_mapping(arguments.columns, arm.n_joint)
    vectors = {**TIP, "base": BASE_ROLES}
    trials = [
        trial
        for path in arguments.motion
        for trial in read_motions(path, arm.n_joint, mapping, arguments.rate_hz, ("q",), vectors)
    ]
    if arguments.ground and len(arguments.ground) != len(trials):
        raise ConfigError(
            f"--ground has {len(arguments.ground)} files for {len(trials)} trials, expected one a trial, in order"
        )
    notes = _masses(arm)
    parts: list[dict[str, np.ndarray]] = []
    acting: list[dict[str, object]] = []
    for trial in trials:
        require_seconds(trial.t, trial.where)
    trials = questioned(map(_kinematic, trials), arm)
    for number, trial in enumerate(progress(trials, "torques", console=console, transient=True), 1):
        plates = read_wrenches(arguments.ground[number - 1]) if arguments.ground else []
        pieces = split_at_holes(trial)
        if len(ends(arm)) > 1 and not arguments.contact:
            base = base_state(arm, trial.t, trial.columns.get("base"), trial.where)
            contacts = placed(arm, trial.t, trial.columns["q"], base, plates)
        else:
            contacts = contacts_of(arguments.contact, plates, arm)
        notes += of_source(light(arm, plates), trial.name)
        of_pieces = [_torques(arm, piece, contacts, trial.identity(number)) for piece in pieces]
        parts.append({name: np.concatenate([part[name] for part, _ in of_pieces]) for name in of_pieces[0][0]})
        for piece, (_, said) in zip(pieces, of_pieces, strict=True):
            notes += of_source((*piece.notes, *said), trial.name)
        acting += [{"trial": trial.name, "plate": p.name, "joint": j} for p, j in contacts]
    shared = [name for name in parts[0] if all(name in part for part in parts)]
    columns = {name: np.concatenate([part[name] for part in parts]) for name in shared}
    if len(parts) > 1:
        labels = trial_column(trials)
        columns["trial"] = np.concatenate([np.full(len(p["t"]), k) for k, p in zip(labels, parts, strict=True)])
    write_motion(arguments.out, columns)
    say_notes(notes)
    rms = np.sqrt(np.nanmean(columns["tau"] ** 2, axis=0))
    show(f"{len(parts)} trial(s), {len(columns['t'])} samples -> {arguments.out}")
    units = ["N m" if joint.type == "revolute" else "N" for joint in arm.joints]
    names = link_names(arm)
    places = dict.fromkeys(f"{one['plate']} acts on {names[int(str(one['joint'])) - 1]}" for one in acting)
    if places:
        show(", ".join(places))
    each = zip(rms, units, strict=True)
    show("rms of what drives each joint: " + ", ".join(f"{value:.3g} {unit}" for value, unit in each))
    return {
        "out": str(arguments.out),
        "trials": len(parts),
        "samples": len(columns["t"]),
        "torque_rms_N_m": per_joint(rms),
        "contacts": acting,
        "notes": documents(notes),
    }


def contacts_of(texts: Sequence[str], plates: Sequence[PlateWrench], arm: Arm) -> list[tuple[PlateWrench, int]]:
    """Return which plate acts on which link.

    Raises
    ------
    ConfigError
        If a plate or link is none of those there, or several plates are loaded and it is unknown on what they act.
    """
    if not plates:
        if texts:
            raise ConfigError("--contact is given, expected --ground with it")
        return []
    if not texts:
        loaded = [plate for plate in plates if plate.is_loaded]
        if len(loaded) > 1:
            names = ", ".join(plate.name for plate in loaded)
            last = next(reversed(segments(arm)), str(arm.n_joint))
            raise ConfigError(
                f"plates {names} are loaded, expected --contact PLATE=LINK for those on this limb, such as "
                f"--contact {loaded[0].name}={last}"
            )
        return [(plate, arm.n_joint) for plate in loaded]
    found = []
    for text in texts:
        name, link = link_named(text, arm)
        by_number = {str(k): plate for k, plate in enumerate(plates, 1)}
        plate = next((p for p in plates if p.name == name), by_number.get(name))
        if plate is None:
            there = ", ".join(p.name for p in plates)
            raise ConfigError(f"--contact {text!r}: no such plate, expected {there}, or a number from 1")
        found.append((plate, link + 1))
    return found


def _masses(arm: Arm) -> list[Note]:
    if any(joint.link.mass_kg > 0.0 for joint in arm.joints):
        return []
    text = (
        "no link of the arm has a mass: these torques are those of friction and of what acts from outside only; "
        "`fitter kinematics --body` takes the table's with --mass, --height and --sex"
    )
    return [Note("no_masses", text)]


def _kinematic(trial: Measured) -> Measured:
    """Return a trial with its motion only: what its torques and tip say of the arm is not asked here."""
    columns = {role: values for role, values in trial.columns.items() if role in _MOTION}
    return replace(trial, columns=columns)


def _torques(
    arm: Arm, trial: Measured, contacts: Sequence[tuple[PlateWrench, int]], identity: TrialId
) -> tuple[dict[str, np.ndarray], list[Note]]:
    t, q = trial.t, trial.columns["q"]
    if not np.isfinite(q).all():
        row = int(np.argmax(~np.isfinite(q).all(axis=1)))
        raise DataError(
            f"{trial.where}: row {trial.first_row + row + 1} has a joint without a number, expected all"
        )
    dq, ddq = _motion(trial)
    base_columns = trial.columns.get("base")
    base = base_state(arm, t, base_columns, trial.where)
    if base_columns is None:
        arm = replace(arm, gravity_m_s2=tuple(gravity_in_world(arm).tolist()))
    notes, wrenches = [], []
    for plate, joint in contacts:
        if plate.t[-1] < t[0] or plate.t[0] > t[-1]:
            raise DataError(
                f"{plate.name}: its forces are from {plate.t[0]:.2f} to {plate.t[-1]:.2f} s and the motion from "
                f"{t[0]:.2f} to {t[-1]:.2f} s, expected one clock"
            )
        force, point, moment = plate.at(t)
        notes += [*unknown(plate.name, t, force), *pulling(arm, plate.name, force)]
        notes += far(arm, q, base, plate.name, joint, force, point)
        wrenches.append(OuterWrench(joint, point, force, moment))
    if base_columns is None and arm.base is not None and is_carried(arm):
        text = f"the motion has no base_x … base_qz although {arm.base.segment} carries the base: it stands"
        notes.append(Note("base_untracked", text))
    tau = needed_torque(arm, q, dq, ddq, base, wrenches, t, identity)
    part = {"t": t, "q": q, "dq": dq, "ddq": ddq, "tau": tau}
    if base_columns is not None:
        part |= dict(zip(BASE_ROLES, base_columns.T, strict=True))
    return part, notes


def _motion(trial: Measured) -> tuple[Floats, Floats]:
    """Return velocities and accelerations, where the file has none by the spline through what it has."""
    columns = trial.columns
    if "dq" in columns and "ddq" in columns:
        return columns["dq"], columns["ddq"]
    if "dq" in columns:
        return columns["dq"], derivatives(trial.t, columns["dq"])[0]
    dq, ddq = derivatives(trial.t, columns["q"])
    return dq, columns.get("ddq", ddq)


def needed_torque(
    arm: Arm,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    base: BaseState,
    wrenches: Sequence[OuterWrench],
    t: Floats,
    trial: AnyTrial,
) -> Floats:
    """Return what must drive the joints: rigid links, friction, effects, less what acts from outside."""
    whole = changed(arm)
    plain = carried_inverse_dynamics(replace(whole, effects=()), q, dq, ddq, base, wrenches)
    tau = plain
    for _ in range(_PASSES if arm.effects else 0):
        before, tau = tau, plain + resisting_torque(arm, q, dq, ddq, tau, t, trial, base=base)
        if np.nanmax(np.abs(tau - before), initial=0.0) < _AGREED_N_M:
            break
    return np.asarray(tau)
