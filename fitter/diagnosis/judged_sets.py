"""The base and the final model held against trials that had no say in anything."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from arm.model import Arm
from fitter.diagnosis.judgement import Errors, judged
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression

#: A fitted model, and the arm that it is, to be simulated.
Fitted = tuple[Candidate, Arm]


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
        """Return the errors before and after of every trial; trials of one name are told apart by their sets."""
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


def judged_sets(
    regression: Regression,
    models: tuple[Fitted, Fitted],
    motions: Sequence[Motion],
    sets: Sequence[str],
    horizon_s: float,
) -> Judged:
    """Return what two models get wrong on trials that had no say in anything.

    Parameters
    ----------
    regression : Regression
    models : (before, after)
        Each with its arm.
    motions : sequence of Motion
        Not thinned, under numbers that no other trial of the run has.
    sets : sequence of str
        The set that each of them is of.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    """
    (base, base_arm), (final, arm) = models
    before = judged(regression, base, base_arm, motions, horizon_s)
    after = before if final is base else judged(regression, final, arm, motions, horizon_s)
    return Judged(sets, [motion.trial.name for motion in motions], before, after)
