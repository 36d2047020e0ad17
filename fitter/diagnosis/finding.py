"""What a diagnosis has found, and its document."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from arm.model import Arm
from fitter.diagnosis.basis_functions import Discrepancy
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.held_out_error import Errors, Gain, Judged
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.search import Search, StaticFriction, Verdict
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note, documents


@dataclass(frozen=True)
class NamedCause:
    """One cause.

    Attributes
    ----------
    effect : str
    joints : tuple of int
        From 1; empty for an effect of the whole arm.
    parameters : mapping from name to FittedParameter
    support : float
        How much of the belief it has among its equals, 0 to 1.
    where : mapping
        Trials or time, where it is not always there.
    takes_away : mapping of str to float
        By role, ``learn`` and ``evaluate``: share of the squared residual that it took away when it was accepted.
    in_stead : bool
        Whether it is an equal of the cause before it.
    """

    effect: str
    joints: tuple[int, ...]
    parameters: Mapping[str, FittedParameter]
    support: float
    where: Mapping[str, object] = field(default_factory=dict)
    takes_away: Mapping[str, float] = field(default_factory=dict)
    in_stead: bool = False

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        numbers: dict[str, object] = {
            name: {"value": p.value, "std": p.std, "unit": p.unit} for name, p in self.parameters.items()
        }
        for name, value in self.where.items():
            numbers[name] = {"value": value, "std": None, "unit": "s" if name.endswith("_s") else "1"}
        return {
            "effect": self.effect,
            "joints": list(self.joints),
            "parameters": numbers,
            "support": self.support,
            "takes_away": dict(self.takes_away),
        }


@dataclass(frozen=True)
class ResidualSize:
    """What the final model leaves, on the evaluating trials.

    Attributes
    ----------
    torque_rms_N_m : sequence of float
        Of every joint.
    share : float
        Of what the base model leaves, as rms, 0 to 1.
    times_noise : float
        Standard deviation of the torque equation's residual in units of the sensors' noise, of the joint that has
        most of it.
    """

    torque_rms_N_m: Sequence[float]
    share: float
    times_noise: float


@dataclass(frozen=True)
class Polished:
    """What became of errors on the evaluating trials when simulated motion moved the final model's numbers.

    Attributes
    ----------
    kept : bool
        Whether the angles gained, the torque, if it was measured, lost nothing beyond chance, and every size stays
        significant.
    before, after : Errors
    is_significant : bool
        Whether the moved size of every cause differs significantly from none.
    """

    kept: bool
    before: Errors
    after: Errors
    is_significant: bool = True

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {"before": self.before.document(), "after": self.after.document()}

    @property
    def sentence(self) -> str:
        """What was done, what it gained, and what follows."""
        what, sizes, unit = "angles", [one.angle_deg for one in (self.before, self.after)], "°"
        if sizes[0] is None:
            what, sizes, unit = "positions", [one.position_m for one in (self.before, self.after)], " m"
        means = [one["mean"] for one in sizes if one is not None]
        moved = [f"{size:.3g}{unit}" if np.isfinite(size) else "away" for size in means]
        torque = [", ".join(f"{size:.3g}" for size in one.torque_rms) for one in (self.before, self.after)]
        kept = "the moved numbers are kept" if self.kept else "so the numbers of the torque's equations stand"
        if not self.is_significant:
            kept = f"a cause's size would no longer differ from none, {kept}"
        return (
            "the numbers were moved by the simulated motion of the learning trials; on the trials held back the "
            f"{what}' mean error went from {moved[0]} to {moved[1]} and the torque's rms from {torque[0]} to "
            f"{torque[1]}: {kept}"
        )


@dataclass(frozen=True)
class Tried:
    """One candidate: the share of the squared residual that it takes away on the evaluating trials."""

    effect: str
    joints: tuple[int, ...]
    gain: float
    support: float

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            "effect": self.effect,
            "joints": list(self.joints),
            "gain": self.gain,
            "support": self.support,
        }


@dataclass(frozen=True)
class Finding:
    """What a diagnosis has found.

    Attributes
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    causes, candidates : sequence
        Candidates ranked, all that were tried.
    complete : bool
        Whether the residual is no more than the sensors' noise.
    residual_size : ResidualSize
    confusable : sequence of pairs of effects
        That this data cannot distinguish.
    next_experiment : str
    before, after : Errors
        On the evaluating trials.
    gain : Gain
    remainder : Remainder
        Of the final model.
    structure : float
        What the base model leaves beyond noise, in units of the noise.
    base_arm, arm : Arm
        Learnt without, and with the causes.
    warnings : sequence of Note
        What makes less of the verdict than it says.
    notes : sequence of Note
        What was done to the data.
    suspected : sequence of effect and joints
        What explains much of it, but not enough to be named.
    judged : Judged, optional
        What both models get wrong on trials that had no say in anything, if there are any.
    polish : Polished, optional
        What numbers moved by simulated motion gained, if that was tried.
    torque_explained : mapping of str to sequence of float
        By role, ``learn`` and ``evaluate``: of every joint, 1 − power of the torque that the final model leaves /
        power of the torque, while the joint moves; NaN where it never does.
    """

    verdict: Verdict
    complete: bool
    residual_size: ResidualSize
    causes: Sequence[NamedCause]
    candidates: Sequence[Tried]
    confusable: Sequence[tuple[str, str]]
    next_experiment: str
    before: Errors
    after: Errors
    gain: Gain
    discrepancy: Discrepancy
    structure: float
    base_arm: Arm
    arm: Arm
    warnings: Sequence[Note] = ()
    notes: Sequence[Note] = ()
    suspected: Sequence[tuple[str, tuple[int, ...]]] = ()
    torque_explained: Mapping[str, Sequence[float]] = field(default_factory=dict)
    judged: Judged | None = None
    polish: Polished | None = None

    def document(self) -> dict[str, object]:
        """Return the JSON document of ``fitter diagnose``."""
        return {
            "verdict": self.verdict,
            "complete": self.complete,
            "left": vars(self.residual_size),
            "causes": [cause.document() for cause in self.causes],
            "candidates": [candidate.document() for candidate in self.candidates],
            "confusable": [list(pair) for pair in self.confusable],
            "next_experiment": self.next_experiment,
            "before": self.before.document(),
            "after": self.after.document(),
            "gain": self.gain.document(),
            "polished": self.polish is not None and self.polish.kept,
            "polish": None if self.polish is None else self.polish.document(),
            "judged": None if self.judged is None else self.judged.document(),
            "residual": {
                "explained": self.discrepancy.explained,
                "white": self.discrepancy.white,
                "depends_on": list(self.discrepancy.depends_on),
                "joint": self.discrepancy.joint or None,
                "formula": self.discrepancy.formula or None,
                "dependences": [vars(one) for one in self.discrepancy.dependences],
                "trial_offsets_N_m": list(self.discrepancy.trial_offsets_N_m),
            },
            "explained": self.torque_explained,
            "structure": {"beyond_noise": self.structure},
            "suspected": [{"effect": effect, "joints": list(joints)} for effect, joints in self.suspected],
            "notes": documents([*self.warnings, *self.notes]),
        }


#: Errors of which nothing is known.
UNKNOWN_ERRORS: dict[str, object] = {
    "torque_rms_N_m": None,
    "torque_rms_unfiltered_N_m": None,
    "angle_error_deg": {"mean": None, "rms": None, "max": None},
}

#: A residual torque of which nothing is known.
UNKNOWN_RESIDUAL: dict[str, object] = {
    "explained": None,
    "white": None,
    "depends_on": [],
    "joint": None,
    "formula": None,
    "dependences": [],
    "trial_offsets_N_m": None,
}

#: What stands in a document of ``fitter diagnose`` where no torque is diagnosed.
UNKNOWN: dict[str, object] = {
    "polished": False,
    "polish": None,
    "judged": None,
    "residual": UNKNOWN_RESIDUAL,
    "explained": None,
    "structure": {"beyond_noise": None},
    "suspected": [],
}


@dataclass(frozen=True)
class Conclusion:
    """What a search has come to.

    Attributes
    ----------
    search : Search
        With the causes that rests of the joints reveal.
    verdict : {"named", "ambiguous", "none", "unexplained"}
    final : Candidate
        The search's final model, or its base where no cause is believed.
    numbers : Estimates
        Of the search's final model.
    remainder : Remainder
        What `final` leaves.
    held : sequence of Holding
        Joints that are held by static friction.
    equals : mapping of int to Candidate
        With a hump of friction that might as well hold such a joint, by its number.
    """

    search: Search
    verdict: Verdict
    final: Candidate
    numbers: Estimates
    discrepancy: Discrepancy
    held: Sequence[StaticFriction]
    equals: Mapping[int, Candidate]
