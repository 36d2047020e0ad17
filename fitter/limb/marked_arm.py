"""An arm with markers, taken apart for tracking: its chain, its markers, and the segment that carries its base."""

from dataclasses import dataclass, replace

import numpy as np

from arm.base_pose import base_in_segment
from arm.body.landmarks import limb_map
from arm.body.limbs import LIMBS
from arm.body.whole_body import body_map, is_whole_body
from arm.model import Arm
from fitter.limb.base_motion import BaseMotion
from fitter.limb.floating_base import floating_joints
from fitter.limb.free_geometry import Geometry, geometry_of
from fitter.limb.initial_geometry import joint_prior
from fitter.limb.marker_observations import SWAY, AnglePrior, MarkerModel, base_follows, with_base
from limbcal.errors import ConfigError

#: How far a marker wanders where the arm file does not say so, and at the least [m].
_USUAL_STD_M, _LEAST_STD_M = 0.008, 0.004


@dataclass(frozen=True)
class MarkedArm:
    """An arm with markers, as tracking takes it apart: the chain, its markers, the base's, and both's."""

    geometry: Geometry
    markers: MarkerModel
    base: BaseMotion
    everything: MarkerModel
    angles: AnglePrior

    @property
    def names(self) -> tuple[str, ...]:
        """All markers, those of the links first."""
        return (*self.markers.names, *self.base.markers)


def marked_arm(arm: Arm) -> MarkedArm:
    """Take an arm apart.

    Raises
    ------
    ConfigError
        If it has no markers on its links, or a joint that slides and is none of a floating base.
    """
    on_links = [m for m in arm.markers if m.joint > 0]
    if not on_links:
        raise ConfigError(
            f"arm {arm.name!r} has no [[marker]] on its links, expected those of `fitter kinematics --body`"
        )
    n_floating = 0 if arm.base is not None and arm.base.segment else floating_joints(arm)
    if any(joint.type != "revolute" for joint in arm.joints[n_floating:]):
        raise ConfigError(
            f"arm {arm.name!r} has a joint that slides, expected only joints that turn, to track markers"
        )
    base_R, base_p = base_in_segment(arm)
    model = MarkerModel(
        tuple(m.name for m in on_links),
        np.array([m.joint - 1 for m in on_links], dtype=np.int64),
        np.array([m.position_m for m in on_links]),
        np.array([max(m.std_m or _USUAL_STD_M, _LEAST_STD_M) for m in on_links]),
        0 if n_floating else SWAY,
    )
    carried = [m for m in arm.markers if m.joint == 0]
    points = np.array([m.position_m for m in carried]).reshape(-1, 3) @ base_R.T + base_p
    segment = None if arm.base is None else arm.base.segment
    base = BaseMotion(segment, tuple(m.name for m in carried), points, np.empty((0, 3, 3)), np.empty((0, 3)))
    angles = joint_prior(arm, _balls(arm), n_floating)
    in_frame_0 = np.array([m.position_m for m in carried]).reshape(-1, 3)
    base_std = max([_LEAST_STD_M, *(m.std_m or _USUAL_STD_M for m in carried)])
    everything = with_base(model, base.markers, in_frame_0, base_std)
    geometry = replace(geometry_of(arm), base_R=base_R, base_p=base_p)
    if not n_floating:
        sway = np.zeros(SWAY)
        with_sway = (np.concatenate([sway, angles.mean]), np.concatenate([sway + 1.0, angles.information]))
        angles = base_follows(AnglePrior(*with_sway), len(carried))
    return MarkedArm(geometry, model, base, everything, angles)


def _balls(arm: Arm) -> tuple[int, ...]:
    if arm.name in LIMBS:
        return limb_map(arm.name, arm.n_joint).balls
    return body_map().balls if is_whole_body(arm) else ()
