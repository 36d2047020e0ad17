"""Errors on trials held back: of torque and of simulated motion, and what a model gains on them."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import CONFIDENCE
from limbcal.note import Note

#: Fewest blocks with an interval: of three the draw of one of them thrice has 3.7 %, more than either tail.
LEAST_BLOCKS = 4
NO_INTERVAL = Note(
    "short",
    f"the evaluating trials last less than {LEAST_BLOCKS} blocks of about a second: the gain has no interval",
)


@dataclass(frozen=True)
class Errors:
    """What a model gets wrong on some trials.

    Attributes
    ----------
    torque_square : (n_block, n_joint)
        Sum of squares, in blocks of about a second, of the torque that it leaves unexplained while the joint
        moves, as far up in frequency as the noise of differentiated angles lets it be seen.
    torque_count : (n_block, n_joint)
    block_trial : (n_block,) of int
        The trial that each block is in, from 0.
    unfiltered_square : (n_trial, n_joint), or None
        The sum of squares of the torque as it was measured, noise included; None where none was.
    motion_square, motion_sum, motion_max : (n_trial, n_joint)
        Of simulated against measured angles and positions [rad or m]; infinite where the simulation ran away.
    motion_count : (n_trial, n_joint)
    turns : (n_joint,) of bool
        Whether a joint turns; the others slide.
    simulated : sequence of (n_sample, n_joint)
        The angles of each trial.
    """

    torque_square: Floats
    torque_count: Floats
    block_trial: NDArray[np.intp]
    unfiltered_square: Floats | None
    motion_square: Floats
    motion_sum: Floats
    motion_max: Floats
    motion_count: Floats
    turns: NDArray[np.bool_]
    simulated: Sequence[Floats]

    @property
    def torque_rms(self) -> Floats:
        """Of every joint, (n_joint,)."""
        return self._rms(self.torque_square)

    @property
    def unfiltered_rms(self) -> Floats | None:
        """Of every joint's torque as it was measured, (n_joint,)."""
        return None if self.unfiltered_square is None else self._rms(self.unfiltered_square)

    def _rms(self, square: Floats) -> Floats:
        return np.asarray(np.sqrt(square.sum(axis=0) / np.maximum(self.torque_count.sum(axis=0), 1.0)))

    @property
    def motion_mean(self) -> Floats:
        """Of every joint over all trials, (n_joint,) [rad or m]."""
        return np.asarray(self.motion_sum.sum(axis=0) / np.maximum(self.motion_count.sum(axis=0), 1.0))

    @property
    def angle_deg(self) -> dict[str, float] | None:
        """Mean, rms and max over all trials and joints that turn [deg]; None if none does."""
        return self._sizes(self.turns, float(np.rad2deg(1.0)))

    @property
    def position_m(self) -> dict[str, float] | None:
        """The same of joints that slide [m]; None if none does."""
        return self._sizes(~self.turns, 1.0)

    def _sizes(self, joints: NDArray[np.bool_], unit: float) -> dict[str, float] | None:
        if not np.any(joints):
            return None
        count = max(float(self.motion_count[:, joints].sum()), 1.0)
        return {
            "mean": unit * float(self.motion_sum[:, joints].sum()) / count,
            "rms": unit * float(np.sqrt(self.motion_square[:, joints].sum() / count)),
            "max": unit * float(self.motion_max[:, joints].max(initial=0.0)),
        }

    def only(self, which: Sequence[int]) -> "Errors":
        """Return the errors of some of the trials."""
        some = list(which)
        raw, own = self.unfiltered_square, [np.flatnonzero(self.block_trial == k) for k in some]
        blocks = np.concatenate(own)
        return Errors(
            self.torque_square[blocks],
            self.torque_count[blocks],
            np.repeat(np.arange(len(some)), [len(one) for one in own]),
            None if raw is None else raw[some],
            self.motion_square[some],
            self.motion_sum[some],
            self.motion_max[some],
            self.motion_count[some],
            self.turns,
            [self.simulated[k] for k in some],
        )

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        raw = self.unfiltered_rms

        def finite(sizes: dict[str, float] | None) -> dict[str, float | None] | None:
            if sizes is None:
                return None
            return {name: size if np.isfinite(size) else None for name, size in sizes.items()}

        return {
            "torque_rms_N_m": self.torque_rms.tolist(),
            "torque_rms_unfiltered_N_m": None if raw is None else raw.tolist(),
            "angle_error_deg": finite(self.angle_deg),
            "position_error_m": finite(self.position_m),
        }


@dataclass(frozen=True)
class Gain:
    """By which share rms errors fell: of torque, angle and position; with an interval of the first.

    Attributes
    ----------
    torque : float
    angle, position : float
        NaN where no joint turns, or slides, or a simulation ran away.
    ci95 : (float, float), or None
        Of the torque's; None where there are too few blocks.
    """

    torque: float
    angle: float
    position: float
    ci95: tuple[float, float] | None

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        motions = {"angle": self.angle, "position": self.position}
        return {
            "torque": self.torque,
            **{name: fell if np.isfinite(fell) else None for name, fell in motions.items()},
            "ci95": None if self.ci95 is None else list(self.ci95),
        }


def gain(before: Errors, after: Errors, n_drawn: int = 1000) -> Gain:
    """Return by how much a model became better.

    For the interval blocks are drawn anew, and trials (Efron and Tibshirani 1993), for errors of one trial may
    resemble each other: the ends are those farther apart. One trial drawn anew is the same again.
    """

    def fell(was: Floats, became: Floats) -> Floats:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(1.0 - np.sqrt(became / was), dtype=np.float64)

    blocks = np.stack([one.torque_square.sum(axis=1) for one in (before, after)])
    trials = np.stack([np.bincount(before.block_trial, weights=own) for own in blocks])
    ends = []
    for parts in (blocks, trials):
        drawn = np.random.default_rng(0).integers(0, parts.shape[1], (n_drawn, parts.shape[1]))
        tails = 0.5 + 0.5 * CONFIDENCE * np.array([-1.0, 1.0])
        ends.append(np.nanquantile(fell(*parts[:, drawn].sum(axis=2)), tails))
    low, high = float(np.min(ends)), float(np.max(ends))
    motion = np.stack([one.motion_square.sum(axis=0) for one in (before, after)])
    angle, position = (fell(*motion[:, joints].sum(axis=1)) for joints in (before.turns, ~before.turns))
    known = len(before.torque_square) >= LEAST_BLOCKS
    return Gain(float(fell(*blocks.sum(axis=1))), float(angle), float(position), (low, high) if known else None)


@dataclass(frozen=True)
class Judged:
    """What the base and the final model get wrong on trials that had no say in anything.

    Attributes
    ----------
    sets, trials : sequence of str
        Of every trial, the set that it is of, and its name.
    before, after : Errors
    """

    sets: Sequence[str]
    trials: Sequence[str]
    before: Errors
    after: Errors

    def by_set(self) -> dict[str, tuple[Errors, Errors]]:
        """Return the errors before and after of every set."""
        places: dict[str, list[int]] = {}
        for k, name in enumerate(self.sets):
            places.setdefault(name, []).append(k)
        return {name: (self.before.only(some), self.after.only(some)) for name, some in places.items()}

    def by_trial(self) -> dict[str, tuple[Errors, Errors]]:
        """Return the errors before and after of every trial; those of one name are distinguished by their sets."""
        names = [
            f"{one}/{name}" if count > 1 else name
            for one, name, count in zip(
                self.sets, self.trials, map(Counter(self.trials).__getitem__, self.trials), strict=True
            )
        ]
        same = Counter[str]()
        parted = {}
        for k, name in enumerate(names):
            same[name] += 1
            own = name if same[name] == 1 else f"{name} ({same[name]})"
            parted[own] = self.before.only([k]), self.after.only([k])
        return parted

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            when: {
                **errors.document(),
                "sets": {name: both[k].document() for name, both in self.by_set().items()},
                "trials": {name: both[k].document() for name, both in self.by_trial().items()},
            }
            for k, (when, errors) in enumerate((("before", self.before), ("after", self.after)))
        }
