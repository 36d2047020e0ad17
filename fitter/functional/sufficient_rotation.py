"""Whether a joint is observable: sufficient rotation between its segments, in frames that show both."""

import numpy as np
from numpy.typing import NDArray

from fitter.functional.relative_motion import RelativeMotion, Turning, part_sums, relative_motion, turning
from fitter.functional.segment_motion import SegmentMotion
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: Turn, rms, that a centre's place or an axis needs to be called revealed [rad]: 8°, a swing of 11° to each side.
#: Skin turns a cluster by 3° rms about the bone (Benoit et al. 2006), and (3/8)² = 14 % is how far such noise in
#: the regressor draws a centre towards the markers.
LEAST_TURN_RAD = np.radians(8.0)
#: The same for noise as large as the residuals of the markers show it: (1/3)² = 11 %.
_LEAST_TURN_IN_NOISE = 3.0


def least_turn_rad(parent: SegmentMotion, child: SegmentMotion) -> float:
    """Return the turn, rms, that is needed between two segments, as noisy as their markers show them [rad]."""
    noise = np.sqrt(parent.turn_variance_rad2 + child.turn_variance_rad2)
    return max(float(LEAST_TURN_RAD), _LEAST_TURN_IN_NOISE * float(noise))


def joint_motion(joint: str, parent: SegmentMotion, child: SegmentMotion) -> RelativeMotion:
    """Return the frames that show both segments.

    Raises
    ------
    NotIdentifiable
        If there are none.
    """
    motion = relative_motion(parent.trials, child.trials)
    if not motion.n_frame:
        seen = (
            f"{int(parent.whole.valid.sum())} and {int(child.whole.valid.sum())} frames have a pose, none together"
        )
        raise NotIdentifiable(f"{joint}: of {parent.name} and {child.name} {seen}, expected frames that show both")
    return motion


def moved_trials(motion: RelativeMotion, n_unobservable: int) -> list[NDArray[np.bool_]]:
    """Return each trial (half of the only one) by itself that turned enough to determine what all determine.

    Parameters
    ----------
    motion : RelativeMotion
    n_unobservable : int
        Directions that all together leave open.
    """
    grams = part_sums(motion, motion.parts.trial).gram
    enough = [i for i, gram in enumerate(grams) if turning(gram).turned_rad[n_unobservable] >= LEAST_TURN_RAD]
    return [np.arange(len(grams)) == i for i in enough]


def nothing_turned(joint: str, turned: Turning, parent: SegmentMotion, child: SegmentMotion, motion: str) -> str:
    """Return the sentence for a joint that stood still; ``motion`` is what would reveal it."""
    seen = f"{np.degrees(turned.turned_rad[2]):.1f}° rms"
    need = f"{np.degrees(least_turn_rad(parent, child)):.0f}°"
    return f"{joint}: {child.name} turned by {seen} relative to {parent.name}, expected at least {need}: {motion}"


def trial_notes(joint: str, parent: SegmentMotion, trials: list[NDArray[np.bool_]]) -> tuple[Note, ...]:
    """Say what the error lacks where there are no two trials that determine the joint."""
    if len(parent.trials) > 1 and len(trials) > 1:
        return ()
    which = (
        "parts of one trial" if len(parent.trials) == 1 else "trials of which no two turned enough by themselves"
    )
    text = f"the error of {joint} is from {which} and does not know how trials differ: record a second one"
    return (Note("one_trial", text),)
