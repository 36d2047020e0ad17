"""Disturbance pulses: their times are part of the finding, as those of loads are (`payload`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others (`missed_pulses`).
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
from fitter.diagnosis.torque.pulse import Pulse, pulse_area

_NUMBERS = ("start_s", "duration_s", "torque_N_m")
#: So far an end may move from where it was found, as a share of the duration: a push never vanishes.
_MOVES = 0.45


def _area(until: Floats, place: tuple[float, float, str]) -> Floats:
    return pulse_area(until, *place)


class DisturbancePulses(Hypothesis):
    """Some pushes at one joint.

    Each has its impulse as a factor: of a short push that is known better than torque and duration. The psi are
    its start and its end, if they are seen: how far they are from where they were found, in durations, from 1.

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
        #: Whether start and end of each are seen, (n_pulse, 2).
        self._seen = np.array([one.unseen_s for one in self.found]).reshape(-1, 2) == 0.0
        #: Of each motion, which stays so that its id does, and push: where that was last, and its column, 0 where
        #: it is far. A slope moves one push only.
        self._made: dict[tuple[int, int], tuple[Motion, tuple[float, float], Floats | float]] = {}

    @property
    def low(self) -> Floats:
        """How far the ends may move back, (n_psi,)."""
        return np.full(np.count_nonzero(self._seen), 1.0 - _MOVES)

    @property
    def high(self) -> Floats:
        """How far they may move on, (n_psi,)."""
        return np.full(np.count_nonzero(self._seen), 1.0 + _MOVES)

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return where they were found, (1, n_psi)."""
        return np.ones((1, np.count_nonzero(self._seen)))

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of samples at which each may begin."""
        return float(len(self.found) * np.log(sum(len(motion.t) for motion in motions)))

    def acts_in(self, motion: Motion) -> bool:
        """Say whether one of them was found there."""
        return any(one.start_s < motion.t[-1] and one.ends_s > motion.t[0] for one in self.found)

    def _places(self, psi: Floats) -> Floats:
        """Return start and duration of each push, (n_pulse, 2) [s]."""
        moved = np.ones(self._seen.shape)
        moved[self._seen] = psi
        lasting = np.array([one.duration_s for one in self.found])
        ends = np.array([(one.start_s, one.ends_s) for one in self.found]) + (moved - 1.0) * lasting[:, None]
        return np.stack([ends[:, 0], ends[:, 1] - ends[:, 0]], axis=1)

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with what an impulse of 1 N m s of each push asks of the drive."""
        column = np.zeros((*hypothetical.q.shape, len(self.found)))
        for k, (start_s, duration_s) in enumerate(self._places(psi)):
            column[:, self.joints[0], k] = self._column(
                hypothetical.motion, k, (float(start_s), float(duration_s))
            )
        return replace(hypothetical, columns=(*hypothetical.columns, column))

    def _column(self, motion: Motion, k: int, place: tuple[float, float]) -> Floats | float:
        """Return what an impulse of 1 N m s of a push at some place asks of the drive, (n,), or 0 throughout."""
        made = self._made.get((id(motion), k))
        if made is None or made[1] != place:
            start_s, duration_s = place
            near = (start_s - duration_s, start_s + 2.0 * duration_s)
            area = behind_filter(motion, partial(_area, place=(*place, self.found[k].form)), near)
            made = self._made[id(motion), k] = motion, place, -area / duration_s if np.any(area) else 0.0
        return made[2]

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return start, duration and torque of each push."""
        places = self._places(psi)
        return np.column_stack([places, factors / places[:, 1]]).ravel()

    def standard_errors(self, of_fit: Floats, motions: Sequence[Motion]) -> Floats:
        """Return those with which they were found: rows of the whole run say little of one event's errors."""
        return np.array([(one.start_std, one.duration_std, one.torque_std) for one in self.found]).ravel()

    def pulses(self, psi: Floats, factors: Floats) -> list[Pulse]:
        """Return the pushes as they are by some psi and impulses."""
        return [
            replace(one, start_s=float(start), duration_s=float(lasting), torque_N_m=float(impulse / lasting))
            for one, (start, lasting), impulse in zip(self.found, self._places(psi), factors, strict=True)
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
