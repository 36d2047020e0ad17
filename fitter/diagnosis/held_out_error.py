"""Errors on trials held back: of torque and of simulated motion, and what a model gains on them."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import CONFIDENCE


@dataclass(frozen=True)
class Errors:
    """What a model gets wrong on some trials.

    Attributes
    ----------
    torque_square : (n_trial, n_joint)
        Sum of squares of the torque that it leaves unexplained while the joint moves, as far up in frequency as
        the noise of differentiated angles lets it be seen.
    torque_count : (n_trial, n_joint)
    unfiltered_square : (n_trial, n_joint), or None
        The same of the torque as it was measured, noise included; None where none was.
    angle_square, angle_sum, angle_max : (n_trial,)
        Of simulated against measured angles of joints that turn [rad]; infinite where the simulation ran away.
    angle_count : (n_trial,)
    simulated : sequence of (n_sample, n_joint)
        The angles of each trial.
    """

    torque_square: Floats
    torque_count: Floats
    unfiltered_square: Floats | None
    angle_square: Floats
    angle_sum: Floats
    angle_max: Floats
    angle_count: Floats
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
    def angle_mean_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_sum.sum() / max(self.angle_count.sum(), 1.0)))

    @property
    def angle_rms_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(np.sqrt(self.angle_square.sum() / max(self.angle_count.sum(), 1.0))))

    @property
    def angle_max_deg(self) -> float:
        """Over all trials."""
        return float(np.rad2deg(self.angle_max.max(initial=0.0)))

    def only(self, which: Sequence[int]) -> "Errors":
        """Return the errors of some of the trials."""
        some = list(which)
        raw = self.unfiltered_square
        return Errors(
            self.torque_square[some],
            self.torque_count[some],
            None if raw is None else raw[some],
            self.angle_square[some],
            self.angle_sum[some],
            self.angle_max[some],
            self.angle_count[some],
            [self.simulated[k] for k in some],
        )

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        raw, sizes = self.unfiltered_rms, {"mean": self.angle_mean_deg, "rms": self.angle_rms_deg}
        return {
            "torque_rms_N_m": self.torque_rms.tolist(),
            "torque_rms_unfiltered_N_m": None if raw is None else raw.tolist(),
            "angle_error_deg": {
                name: size if np.isfinite(size) else None
                for name, size in (*sizes.items(), ("max", self.angle_max_deg))
            },
        }


@dataclass(frozen=True)
class Gain:
    """By which share the rms error fell: of torque and of angle; with an interval of the former."""

    torque: float
    angle: float
    ci95: tuple[float, float]

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            "torque": self.torque,
            "angle": self.angle if np.isfinite(self.angle) else None,
            "ci95": list(self.ci95),
        }


def gain(before: Errors, after: Errors, n_drawn: int = 1000) -> Gain:
    """Return by how much a model became better, trials drawn anew for the interval (Efron and Tibshirani 1993)."""
    rng = np.random.default_rng(0)
    n = len(before.torque_square)
    draws = rng.integers(0, n, (n_drawn, n))

    def fell(was: Floats, became: Floats) -> Floats:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(1.0 - np.sqrt(became / was), dtype=np.float64)

    was, became = before.torque_square.sum(axis=1), after.torque_square.sum(axis=1)
    low, high = np.nanquantile(
        fell(was[draws].sum(axis=1), became[draws].sum(axis=1)), 0.5 + 0.5 * CONFIDENCE * np.array([-1.0, 1.0])
    )
    angle = float(fell(before.angle_square.sum(), after.angle_square.sum()))
    return Gain(float(fell(was.sum(), became.sum())), angle, (float(low), float(high)))


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
