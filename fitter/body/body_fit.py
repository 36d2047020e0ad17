"""A calibrated whole person: what a fit found, and how far markers are from it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.marker_kinematics import Integers
from arm.model import Arm
from fitter.body.body_map import BodyLimbs
from fitter.body.start import BodyStart
from fitter.limb.bundle import Bundle, Task
from fitter.limb.floating_base import floating_angles
from fitter.limb.frame_choice import usable_frames
from fitter.limb.inverse_kinematics import follow, predicted
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.marker_errors import MarkerErrors, marker_errors
from fitter.limb.uncertainty import Errors
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording


@dataclass(frozen=True)
class BodyFit:
    """A calibrated person.

    Attributes
    ----------
    arm : Arm
        The preset that it began with.
    where : BodyLimbs
    trials : LimbTrials
    start : BodyStart
    task : Task
    rows : (n,) int64
        Which of all frames were fitted.
    bundle : Bundle
    errors : Errors
    notes : tuple of Note
    """

    arm: Arm
    where: BodyLimbs
    trials: LimbTrials
    start: BodyStart
    task: Task
    rows: Integers
    bundle: Bundle
    errors: Errors
    notes: tuple[Note, ...]

    @property
    def marker_names(self) -> tuple[str, ...]:
        """All markers, in the order of their errors."""
        return tuple(self.bundle.markers.names)

    def marker_errors(self, recordings: Sequence[MarkerRecording], seed: int) -> MarkerErrors:
        """Return how far every marker is from where the tree has it."""
        markers, geometry, prior = self.bundle.markers, self.bundle.geometry, self.task.angles
        y = np.concatenate([one.of(markers.names) for one in recordings])
        n = len(y)
        frames, _ = usable_frames(y, np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)), recordings)
        about = floating_angles(geometry, markers, frames, prior, seed)
        chain = markers.chain(geometry)
        q = follow(chain, frames, markers.std, prior, seed, begin=about)
        return marker_errors(frames, predicted(chain, frames, q))
