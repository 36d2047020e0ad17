"""How far centres that motion shows are off, beyond what repeated trials can show: against images of the bones.

Skin, and a scapula that its markers do not follow, move with the joint's angle and alike in all trials. No
disagreement of trials shows that; it is what methods were found to be off against CT, ultrasound or MRI.
"""

import numpy as np

from arm.body.landmarks import LimbMap
from arm.marker_kinematics import MarkerChain
from arm.model import Floats
from fitter.limb.inverse_kinematics import link_poses
from fitter.limb.marker_observations import SWAY, Frames
from fitter.limb.nan_statistics import nan_median
from limbcal.note import Note

#: Distance of a functional centre from that in images [m]: of the shoulder by SCoRE 20.7 ± 5.5 mm from CT, mean
#: and sd over people, with trials 4.3 mm apart (Asadi Nikooyan et al. 2011); of the hip 13.4 mm from
#: ultrasound (Hicks and Richards 2005).
_AGAINST_IMAGES_M = {"shoulder": float(np.hypot(20.7e-3, 5.5e-3)), "hip": 13.4e-3}


def systematic_std_m(centre: str) -> float:
    """Return how far a centre by motion is off along an axis, alike in all trials [m]; 0: not known."""
    return float(_AGAINST_IMAGES_M.get(centre, 0.0) / np.sqrt(3.0))


def beyond_the_acromion(
    where: LimbMap, frames: Frames, chain: MarkerChain, q: Floats, acromion_m: Floats, length_m: float
) -> Note | None:
    """Say if an upper arm comes out longer than from the acromion, which lies above the shoulder, to the elbow.

    Parameters
    ----------
    where : LimbMap
    frames : Frames
    chain : MarkerChain
    q : (n_frame, 6 + n_joint)
    acromion_m : (n_frame, 3)
        NaN where it was not seen.
    length_m : float
        The upper arm's, at the least.
    """
    _, o = link_poses(chain, frames, q)
    elbow = o[:, SWAY + where.centres["elbow"]]
    far = float(nan_median(np.linalg.norm(acromion_m - elbow, axis=1)[:, None])[0])
    if not far < length_m:
        return None
    text = (
        f"the upper arm comes out over {1e3 * length_m:.0f} mm long, but its acromion is {1e3 * far:.0f} mm from "
        f"the elbow: the markers of {where.base} do not follow the bone, so the chain turns about a point beyond "
        "the shoulder. It follows these markers best; the bone is shorter"
    )
    return Note("beyond_acromion", text)
