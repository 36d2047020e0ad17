"""Disturbance pulses: their times are part of the finding, as those of loads are (`payload`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others (`missed_pulses`). A fit leaves them where they
were found: the equations' weights hold for a whole run, and say less of an event than its own residual does.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from arm.effects.effect import EffectKind
from arm.model import Floats, JointType
from fitter.diagnosis.least_squares import EQUAL_SIGMAS
from fitter.diagnosis.model import Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.sharp_columns import behind_filter
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque.pulse_column import pulse_area

_NUMBERS = ("start_s", "duration_s", "torque_N_m")


def _area(until: Floats, place: tuple[float, float, str]) -> Floats:
    return pulse_area(until, *place)


class DisturbancePulses(Hypothesis):
    """Some pushes at one joint.

    Each has its impulse as a factor: of a short push that is known better than torque and duration.

    Parameters
    ----------
    kind : EffectKind
    joint : int
    found : sequence of Pulse
        On the run's clock.
    """

    is_event = True
    is_inertial = False
    is_intermittent = True
    is_noisy = False
    is_sized_by_factors = True

    def __init__(self, kind: EffectKind, joint: int, found: Sequence[Pulse]) -> None:
        super().__init__(kind, (joint,))
        self.found = tuple(found)
        self.n_column = len(self.found)
        #: What they ask of the drive in each motion, which stays so that its id does, (n_sample, n_pulse).
        self._made: dict[int, tuple[Motion, Floats]] = {}

    @property
    def n_number(self) -> int:
        """How many numbers were chosen: impulses, and the starts and ends that are seen."""
        return self.n_column + int(np.count_nonzero([np.equal(one.unseen_s, 0.0) for one in self.found]))

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of samples at which each may begin."""
        return float(len(self.found) * np.log(sum(len(motion.t) for motion in motions)))

    def acts_in(self, motion: Motion) -> bool:
        """Say whether one of them was found there."""
        return any(one.start_s < motion.t[-1] and one.ends_s > motion.t[0] for one in self.found)

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with what an impulse of 1 N m s of each push asks of the drive."""
        motion = hypothetical.motion
        if id(motion) not in self._made:
            self._made[id(motion)] = motion, np.stack([_column(motion, one) for one in self.found], axis=1)
        column = np.zeros((*hypothetical.q.shape, len(self.found)))
        column[:, self.joints[0]] = self._made[id(motion)][1]
        return replace(hypothetical, columns=(*hypothetical.columns, column))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return start, duration and torque of each push."""
        places = np.array([(one.start_s, one.duration_s) for one in self.found])
        return np.column_stack([places, factors / places[:, 1]]).ravel()

    def standard_errors(self, of_fit: Floats, motions: Sequence[Motion]) -> Floats:
        """Return those with which they were found: rows of the whole run say little of one event's errors."""
        return np.array([(one.start_std, one.duration_std, one.torque_std) for one in self.found]).ravel()

    def pulses(self, factors: Floats) -> list[Pulse]:
        """Return the pushes as they are by some impulses."""
        return [
            replace(one, torque_N_m=float(impulse / one.duration_s))
            for one, impulse in zip(self.found, factors, strict=True)
        ]

    def determined(self, values: Floats, std: Floats) -> NDArray[np.bool_]:
        """Say which numbers are known: those with a standard error, but no torque that differs not from none.

        Of a push too short for the band its impulse is known, and no torque. Of one that begins or ends while
        nothing is known the torque is, though it may have lasted for longer or shorter.
        """
        known, torque = np.isfinite(std), slice(2, None, len(_NUMBERS))
        known[torque] &= np.abs(values[torque]) > EQUAL_SIGMAS * std[torque]
        return np.asarray(known)

    @property
    def names(self) -> tuple[str, ...]:
        """Numbered where there are several pushes."""
        names = [parameter.name for parameter in self.kind.numbers]
        if len(self.found) == 1:
            return tuple(names)
        return tuple(f"{name}_{k + 1}" for k in range(len(self.found)) for name in names)

    def units_at(self, joint: JointType) -> tuple[str, ...]:
        """Return those of each, at joints of a type."""
        return super().units_at(joint) * len(self.found)


def _column(motion: Motion, pulse: Pulse) -> Floats:
    """Return what an impulse of 1 N m s of a push asks of the drive, (n,)."""
    near = (pulse.start_s - pulse.duration_s, pulse.ends_s + pulse.duration_s)
    place = pulse.start_s, pulse.duration_s, pulse.form
    return np.asarray(-behind_filter(motion, partial(_area, place=place), near) / pulse.duration_s)
