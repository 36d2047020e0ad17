"""Whether all contact of a trial is measured, and in which stretches it is where it is not throughout.

A person who sits down on a chair without a plate stands on the plates in between. Bodies can be judged there.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Arm, Floats
from fitter.data.derivatives import lowpass
from fitter.ground.clock_shift import FASTEST_HZ, ClockShift, clock_shift
from fitter.ground.contact import OTHER_WEIGHT, closure, held
from fitter.ground.floating_base import FloatingBase
from fitter.ground.ground_trial import SHORTEST_S, GroundTrial
from limbcal.note import Note
from protocol.markers.recording import runs


def unmeasured(arm: Arm, base: FloatingBase, trial: GroundTrial, names: Sequence[str]) -> list[Note]:
    """Return what shows contact that no plate measures.

    Parameters
    ----------
    arm : Arm
    base : FloatingBase
    trial : GroundTrial
    names : sequence of str
        Of the arm's links.
    """
    ends = [i for i in base.bodies if not any(i in arm.way_to(j)[:-1] for j in base.bodies)]
    up, predicted = _up(arm), trial.Y[:, :3] @ base.links.ravel()
    return [
        *closure(predicted, trial.wrench[:, :3], _weight(arm, base), up, trial.t, trial.dt_s),
        *held(base, trial.motions, ends, [names[i] for i in ends], trial.acts_at_m, up, trial.t, trial.dt_s),
    ]


def measured_stretches(
    arm: Arm, base: FloatingBase, trial: GroundTrial, names: Sequence[str]
) -> list[GroundTrial]:
    """Return the stretches in which the plates carry the person, of a trial in which they do for a time.

    Whether they do is the vertical force behind the filter of the clocks' comparison. What that filter spreads
    beyond a beginning and an end, half a period of its corner, is left out there. The clocks are compared in
    these stretches alone: elsewhere something else drives the motion.

    Parameters
    ----------
    arm : Arm
    base : FloatingBase
    trial : GroundTrial
    names : sequence of str
        Of the arm's links.

    Returns
    -------
    list of GroundTrial
        Of ``SHORTEST_S`` at least, in none of which anything shows contact that is not measured.
    """
    predicted, measured = (
        lowpass(force[:, :3] @ _up(arm), trial.dt_s, FASTEST_HZ, ends="even")
        for force in (trial.Y @ base.links.ravel(), trial.wrench)
    )
    carried = np.abs(measured - predicted) < OTHER_WEIGHT * _weight(arm, base)
    trial = _shifted(base, trial, clock_shift(predicted, measured, trial.dt_s, FASTEST_HZ, carried))
    edge = round(0.5 / FASTEST_HZ / trial.dt_s)
    inner = [
        slice(first + edge * (first > 0), last - edge * (last < len(carried))) for first, last in runs(carried)
    ]
    parts = [trial.during(kept) for kept in inner if (kept.stop - kept.start) * trial.dt_s >= SHORTEST_S]
    return [part for part in parts if not unmeasured(arm, base, part, names)]


def _shifted(base: FloatingBase, trial: GroundTrial, more: ClockShift) -> GroundTrial:
    """Return the trial with its forces moved to where the motion has them, beyond what it was before."""
    about, force = trial.motions[base.bodies[0]].o, trial.wrench[:, :3]
    still = np.hstack([force, trial.wrench[:, 3:] + np.cross(about, force)])  # about what does not move
    still = np.column_stack([np.interp(trial.t + more.shift_s, trial.t, column) for column in still.T])
    wrench = np.hstack([still[:, :3], still[:, 3:] - np.cross(about, still[:, :3])])
    return replace(trial, wrench=wrench, shift=ClockShift(trial.shift.shift_s + more.shift_s, more.std_s))


def _up(arm: Arm) -> Floats:
    gravity = np.array(arm.gravity_m_s2)
    return np.asarray(-gravity / np.linalg.norm(gravity))


def _weight(arm: Arm, base: FloatingBase) -> float:
    mass_kg = arm.body.mass_kg if arm.body is not None else base.links[:, 9].sum()
    return float(np.linalg.norm(arm.gravity_m_s2) * mass_kg)
