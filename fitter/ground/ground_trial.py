"""A trial of a person on plates: motion, and the ground's wrench on the same times."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from arm.base_pose import base_in_segment
from arm.model import Arm, Floats
from arm.moving_base import standing_base
from fitter.data.derivatives import lowpass
from fitter.data.trial import Trial
from fitter.ground.clock_shift import FASTEST_HZ, ClockShift, clock_shift
from fitter.ground.contact import plate_link
from fitter.ground.disturbances import Posture, postures
from fitter.ground.floating_base import FloatingBase, base_regressor
from fitter.ground.ground_wrench import ground_wrench, wrench_at_origin
from fitter.ground.link_motion import LinkMotion, link_motions
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.markers.recording import runs
from protocol.markers.wrench_files import EMPTY_N, PlateWrench, read_wrenches

_Sampled = TypeVar("_Sampled", LinkMotion, Posture)
#: A trial needs this long a stretch in which all plates have numbers [s].
SHORTEST_S = 1.0


@dataclass(frozen=True)
class GroundTrial:
    """One trial.

    Attributes
    ----------
    name : str
    t : (n_sample,) [s]
        On the motion's clock.
    dt_s : float
    motions : list of LinkMotion
        Of all links, in frame 0.
    postures : list of Posture
    Y : (n_sample, 6, 10 n_body)
        Force, and moment about the base link's origin, of the bodies' standard parameters.
    wrench : (n_sample, 6)
        Of the ground, about the same point.
    shift : ClockShift
    contacts : tuple of (str, int)
        Plates that carry something, and the link, from 0, that each acts on.
    acts_at_m : (3,)
        Where the ground acts, in the median.
    notes : tuple of Note
    """

    name: str
    t: Floats
    dt_s: float
    motions: list[LinkMotion]
    postures: list[Posture]
    Y: Floats
    wrench: Floats
    shift: ClockShift
    contacts: tuple[tuple[str, int], ...]
    acts_at_m: Floats
    notes: tuple[Note, ...]

    def during(self, kept: slice) -> "GroundTrial":
        """Return the trial in a stretch of its samples."""
        return replace(
            self,
            t=self.t[kept],
            motions=[_during(motion, kept) for motion in self.motions],
            postures=[_during(posture, kept) for posture in self.postures],
            Y=self.Y[kept],
            wrench=self.wrench[kept],
        )


def ground_trial(
    arm: Arm,
    base: FloatingBase,
    trial: Trial,
    forces: Path,
    contacts: Sequence[tuple[str, int]],
    names: Sequence[str],
) -> GroundTrial:
    """Put a motion and its force file together.

    Parameters
    ----------
    arm : Arm
    base : FloatingBase
    trial : Trial
    forces : Path
    contacts : sequence of (str, int)
        Plates by name or number, from 1, and the link, from 0, where they are known.
    names : sequence of str
        Of the arm's links.

    Raises
    ------
    DataError
        If the forces cannot be used.
    """
    plates = [plate for plate in read_wrenches(forces) if plate.is_loaded]
    if not plates:
        raise DataError(f"{forces}: no plate carries more than {EMPTY_N:g} N, expected the ground's forces")
    t = trial.t + trial.began_s
    motions = link_motions(arm, trial.q, trial.dq, trial.ddq, standing_base(len(t)))
    Y = base_regressor([motions[i] for i in base.bodies])
    theta, up = base.links.ravel(), -np.array(arm.gravity_m_s2) / np.linalg.norm(arm.gravity_m_s2)
    raw, known, notes = ground_wrench(plates, t, str(forces))
    raw = _in_frame_0(arm, raw)
    first, last = _longest(known, trial.dt_s, forces)
    kept = slice(first, last)
    band = min(trial.band_hz, FASTEST_HZ)
    vertical = [lowpass(x @ up, trial.dt_s, band, ends="even") for x in (Y[:, :3] @ theta, raw[:, :3])]
    shift = clock_shift(vertical[0][kept], vertical[1][kept], trial.dt_s, band)
    if shift.shift_s != 0.0:
        raw, known, _ = ground_wrench(plates, t + shift.shift_s, str(forces))
        raw = _in_frame_0(arm, raw)
        first, last = _longest(known, trial.dt_s, forces)
        kept = slice(first, last)
        notes += shift.notes
    if last - first < len(t):
        text = f"{len(t) - (last - first)} of {len(t)} samples have no force of every plate and are left out"
        notes.append(Note("nan_forces", text, from_s=float(t[first]), to_s=float(t[last - 1])))
    if np.isfinite(trial.cutoff_hz):  # the motion has passed this filter: what it is compared with must, too
        raw = lowpass(raw, trial.dt_s, trial.cutoff_hz, ends="even")
    about = motions[base.bodies[0]].o
    wrench = np.hstack([raw[:, :3], raw[:, 3:] - np.cross(about, raw[:, :3])])
    found = GroundTrial(
        trial.name,
        t,
        trial.dt_s,
        motions,
        postures(arm, base, motions, trial.q, trial.dq, trial.ddq),
        Y,
        wrench,
        shift,
        (),
        _acts_at(plates),
        tuple(notes),
    ).during(kept)
    acting = _contacts(base, found.motions, plates, found.t + shift.shift_s, contacts)
    return replace(found, contacts=acting)


def _in_frame_0(arm: Arm, wrench: Floats) -> Floats:
    """Return wrenches at the world's origin as wrenches at frame 0's, in its axes."""
    R, p = base_in_segment(arm)
    force, moment = wrench[:, :3], wrench[:, 3:] - np.cross(p, wrench[:, :3])
    return np.hstack([force @ R, moment @ R])


def _longest(known: np.ndarray, dt_s: float, forces: Path) -> tuple[int, int]:
    stretches = runs(known)
    first, last = max(stretches, key=lambda run: run[1] - run[0]) if stretches else (0, 0)
    if (last - first) * dt_s < SHORTEST_S:
        raise DataError(
            f"{forces}: the longest stretch in which every plate has numbers is {(last - first) * dt_s:.2f} s, "
            f"expected {SHORTEST_S:g} s at least"
        )
    return first, last


def _during(what: _Sampled, kept: slice) -> _Sampled:
    return replace(what, **{each.name: getattr(what, each.name)[kept] for each in fields(what)})


def _acts_at(plates: Sequence[PlateWrench]) -> Floats:
    points = [plate.point_m[np.linalg.norm(plate.force, axis=1) > EMPTY_N] for plate in plates]
    return np.asarray(np.nanmedian(np.concatenate(points), axis=0))


def _contacts(
    base: FloatingBase,
    motions: Sequence[LinkMotion],
    plates: Sequence[PlateWrench],
    t: Floats,
    given: Sequence[tuple[str, int]],
) -> tuple[tuple[str, int], ...]:
    found = []
    for number, plate in enumerate(plates, 1):
        link = next((link for name, link in given if name in (plate.name, str(number))), None)
        if link is None:
            wrench = np.column_stack([np.interp(t, plate.t, x) for x in np.nan_to_num(wrench_at_origin(plate)).T])
            loaded = np.linalg.norm(wrench[:, :3], axis=1) > EMPTY_N
            if not loaded.any():
                continue
            point = np.column_stack([np.interp(t, plate.t, x) for x in np.nan_to_num(plate.point_m).T])
            link = plate_link(base, motions, point, loaded)
        found.append((plate.name, link))
    return tuple(found)
