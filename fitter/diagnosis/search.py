"""What the search for causes has come to."""

from dataclasses import dataclass, field

import numpy as np

from arm.model import Floats
from fitter.diagnosis.agreement import apart, typical
from fitter.diagnosis.screening import Candidate

#: Causes explain too little if they leave this share of what the base model leaves beyond noise, and so much of
#: the noise.
UNEXPLAINED, UNEXPLAINED_AT_LEAST = 0.0125, 1.0
#: Causes that leave so large a share of it lead nowhere.
_LEADS_NOWHERE = 0.05
#: Causes of which trials are typically left with so many times what one unknown function of few variables leaves
#: them with are none: ripples, springs and pushes together can imitate what is in no catalogue. Of true causes, if
#: they are several, such a function explains a part only.
_OUTDONE = 1.5
#: No function leaves less than noise, of which the filter is sure to this much.
_NOISE = 0.7


@dataclass(frozen=True)
class Cause:
    """One accepted hypothesis.

    Attributes
    ----------
    place : int
        Its place in the model.
    rivals : list of Candidate
        Others that would explain as much in its stead; the model with each.
    beaten : list of Candidate
        All others that were tried in its stead, best first.
    worth : float
        By how much the sum of squares grows without it.
    """

    place: int
    rivals: list[Candidate] = field(default_factory=list)
    beaten: list[Candidate] = field(default_factory=list)
    worth: float = 0.0


@dataclass(frozen=True)
class Search:
    """What the search for causes has come to.

    Attributes
    ----------
    base, final : Candidate
        Without and with all causes.
    causes : list of Cause
    first : list of Candidate
        Every hypothesis beside the base model alone, best first.
    told : (n_trial,)
        How many numbers each trial tells: what noise alone would leave.
    function : float
        What trials are typically left with beside one unknown function of few variables in place of all causes,
        in units of what noise would leave.
    from_all : bool
        Whether evaluating trials were learnt from, too.
    """

    base: Candidate
    final: Candidate
    causes: list[Cause]
    first: list[Candidate]
    told: Floats
    function: float = np.inf
    from_all: bool = False

    @property
    def structure(self) -> float:
        """What the base model leaves beyond noise, as a share of the noise."""
        return float((self.base.squares.sum() - self.noise) / self.noise)

    @property
    def noise(self) -> float:
        """The sum of squares that noise alone leaves, not more than anything has left."""
        return float(min(self.told.sum(), self.final.squares.sum()))

    @property
    def outdone(self) -> bool:
        """Whether one unknown function explains clearly more than all causes together."""
        return typical(self.final.squares, self.told) > _OUTDONE * self.function

    @property
    def may_be_outdone(self) -> bool:
        """Whether causes leave so much that a function could explain clearly more."""
        return bool(self.causes) and typical(self.final.squares, self.told) > _OUTDONE * _NOISE

    @property
    def leads_nowhere(self) -> bool:
        """Whether causes leave much of what the base model leaves."""
        return self.leaves(_LEADS_NOWHERE, UNEXPLAINED_AT_LEAST)

    @property
    def is_nearly_all(self) -> bool:
        """Whether several causes explain nearly all."""
        return len(self.causes) > 1 and not self.leads_nowhere

    def leaves(self, share: float, least: float) -> bool:
        """Say whether more is left beyond noise than a share of what the base model leaves, and so much noise.

        Trials that stand apart do not count: whatever happened in them, it is no part of the arm.
        """
        common = ~apart(self.final.squares, self.told)
        noise, left, was = (float(one[common].sum()) for one in (self.told, self.final.squares, self.base.squares))
        return left - noise > max(share * (was - min(noise, left)), least * noise)

    @property
    def explained(self) -> float:
        """Share of that structure which the causes explain, 0 to 1."""
        beyond = self.base.squares.sum() - self.noise
        return float(np.clip((self.base.squares.sum() - self.final.squares.sum()) / max(beyond, 1e-300), 0.0, 1.0))
