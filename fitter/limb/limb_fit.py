"""A calibrated limb: what a fit found, and how far markers are from it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.body.landmarks import LimbMap
from arm.marker_kinematics import Integers
from arm.model import Arm
from fitter.functional.functional_centre import FunctionalCentre
from fitter.limb.base_motion import BaseMotion, markers_in, poses_of
from fitter.limb.bundle import Bundle, Task
from fitter.limb.frame_choice import usable_frames
from fitter.limb.free_geometry import FreeGeometry
from fitter.limb.inverse_kinematics import follow, predicted
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.marker_errors import MarkerErrors, marker_errors
from fitter.limb.marker_observations import Frames, base_follows, with_base
from fitter.limb.search_comparison import Comparison
from fitter.limb.uncertainty import Errors
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording


@dataclass(frozen=True)
class LimbFit:
    """A calibrated limb.

    Attributes
    ----------
    arm : Arm
        The preset that it began with.
    where : LimbMap
    trials : LimbTrials
    base : BaseMotion
    task : Task
    rows : (n,) int64
        Which of all frames were fitted.
    bundle : Bundle
    functional : tuple of FunctionalCentre
    errors : Errors
    notes : tuple of Note
    rivals : Comparison, optional
        Where ``bundle`` is the genetic algorithm's answer: how far that is from the bundle fit's.
    """

    arm: Arm
    where: LimbMap
    trials: LimbTrials
    base: BaseMotion
    task: Task
    rows: Integers
    bundle: Bundle
    functional: tuple[FunctionalCentre, ...]
    errors: Errors
    notes: tuple[Note, ...]
    rivals: Comparison | None = None

    @property
    def free(self) -> FreeGeometry:
        """What was free."""
        return self.task.free

    @property
    def base_std_m(self) -> float:
        """How far a marker of the base wanders along an axis [m]."""
        motion = self.trials.motions.get(str(self.base.segment))
        return (
            float(self.bundle.markers.std[0])
            if motion is None
            else max(float(np.sqrt(motion.variance_m2)), float(self.bundle.markers.std[0]))
        )

    def frames_of_fit(self) -> tuple[Frames, Integers]:
        """Return the frames that were fitted, and which of all they are."""
        return self.task.frames, self.rows

    def frames(self, recordings: Sequence[MarkerRecording]) -> tuple[Frames, NDArray[np.bool_]]:
        """Return the frames of recordings in which base and chain are seen, and which of all they are."""
        y = np.concatenate([r.of(self.bundle.markers.names) for r in recordings])
        carried = np.concatenate([r.of(self.base.markers) for r in recordings])
        R, p = poses_of(self.base.points_m, carried)
        return usable_frames(y, R, p, recordings)

    @property
    def marker_names(self) -> tuple[str, ...]:
        """Markers of the links, then those of the base."""
        return (*self.bundle.markers.names, *self.base.markers)

    def marker_errors(self, recordings: Sequence[MarkerRecording], seed: int) -> MarkerErrors:
        """Return how far every marker is from where the chain has it.

        Returns
        -------
        MarkerErrors
            Of the markers of the links, then those of the base, which is where base and limb together have it.
        """
        frames, usable = self.frames(recordings)
        carried = np.concatenate([r.of(self.base.markers) for r in recordings])[usable]
        frames = frames._replace(y=np.ascontiguousarray(np.concatenate([frames.y, carried], axis=1)))
        geometry, base = self.bundle.geometry, self.base
        place = markers_in(base.points_m, geometry.base_R, geometry.base_p)
        model = with_base(self.bundle.markers, base.markers, place, self.base_std_m)
        chain = model.chain(geometry)
        prior = base_follows(self.task.angles, len(base.markers))
        q = follow(chain, frames, model.std, prior, seed)
        return marker_errors(frames, predicted(chain, frames, q))
