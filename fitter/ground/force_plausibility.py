"""Forces on a person's links that cannot be right: unknown ones, of the other sign, in another unit, elsewhere."""

from collections.abc import Sequence

import numpy as np

from arm.kinematics import axis_frames
from arm.model import STANDARD_GRAVITY_M_S2, Arm, Floats
from arm.moving_base import BaseState
from fitter.ground.link_names import segments
from limbcal.note import Note
from protocol.markers.wrench_files import EMPTY_N, PlateWrench

#: A foot's length of a tall person [m]: 0.152 of 1.95 m (Drillis and Contini 1966).
_FOOT_M = 0.3
#: Least peak force of a person who stands on plates, as a fraction of body weight: one foot of two, half of it
#: beside the plate. A force in kgf is a tenth of one in newtons.
_LEAST_CARRIED = 0.25


def unknown(plate: str, t: Floats, force: Floats) -> list[Note]:
    """Say where a plate's force is not known: the torques of the joints that carry its link are not, either.

    Parameters
    ----------
    plate : str
    t : (n_sample,) [s]
    force : (n_sample, 3) [N]
        NaN where it is not known.
    """
    lost = np.isnan(force).any(axis=1)
    if not lost.any():
        return []
    text = f"{plate} has no force in {np.count_nonzero(lost)} of {len(t)} samples: no torque is known there"
    at = t[lost]
    return [Note("nan_forces", text, columns=(plate,), from_s=float(at[0]), to_s=float(at[-1]))]


def pulling(arm: Arm, plate: str, force: Floats) -> list[Note]:
    """Say if a plate pulls a person's link downwards while it is loaded, as no ground does.

    Parameters
    ----------
    arm : Arm
        Its gravity is in the laboratory's frame, as with every base that moves.
    plate : str
    force : (n_sample, 3) [N]
        In the laboratory's frame.
    """
    loaded, gravity = _is_loaded(force), np.array(arm.gravity_m_s2)
    if not segments(arm) or not loaded.any() or not gravity.any():
        return []
    pull_N = float(np.median((force @ gravity)[loaded])) / float(np.linalg.norm(gravity))
    if pull_N < EMPTY_N:
        return []
    text = (
        f"{plate} pulls its link downwards with {pull_N:.0f} N: are these the forces on the ground? Those on the "
        f"person have the other sign"
    )
    return [Note("sign", text, columns=(plate,))]


def light(arm: Arm, plates: Sequence[PlateWrench]) -> list[Note]:
    """Say if all plates together never carry what a person who stands on them must: their unit may be another."""
    if arm.body is None or not plates:
        return []
    t = plates[0].t
    total = sum(np.interp(t, one.t, np.linalg.norm(np.nan_to_num(one.force), axis=1)) for one in plates)
    most_N, weight_N = float(np.max(total)), arm.body.mass_kg * STANDARD_GRAVITY_M_S2
    if most_N >= _LEAST_CARRIED * weight_N:
        return []
    text = (
        f"the plates carry {most_N:.0f} N at the most, and the person weighs {weight_N:.0f} N: are the forces in "
        f"another unit, such as kgf?"
    )
    return [Note("unit", text)]


def far(
    arm: Arm, q: Floats, base: BaseState, plate: str, joint: int, force: Floats, point_m: Floats
) -> list[Note]:
    """Say if a plate's force acts farther from a person's link than a foot is long.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]
    base : BaseState
    plate : str
    joint : int
        Whose link it acts on, from 1.
    force, point_m : (n_sample, 3) [N], [m]
        In the laboratory's frame.
    """
    loaded = _is_loaded(force)
    if not segments(arm) or not loaded.any():
        return []
    origin = np.einsum("nij,nj->ni", base.R, axis_frames(arm, q)[:, joint - 1, :3, 3]) + base.p
    away = float(np.median(np.linalg.norm(point_m - origin, axis=1)[loaded]))
    if away < _FOOT_M:
        return []
    text = (
        f"{plate} acts {away:.2f} m from link {joint} while it is loaded, farther than a foot is long: perhaps it "
        "is under the other foot, or in another frame"
    )
    return [Note("contact_far", text)]


def _is_loaded(force: Floats) -> np.ndarray:
    return np.asarray(np.linalg.norm(np.nan_to_num(force), axis=1) > EMPTY_N)
