"""What an arm may do beyond its base parameters: hypotheses, models of some of them, and fitted models.

A hypothesis is one effect at some joints, with numbers that are sought on a grid first and then refined.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum, auto

import numpy as np
from numpy.typing import NDArray

from arm.effects.effect import EffectKind
from arm.model import Arm, Floats, JointType
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.least_squares import SLOPE
from fitter.diagnosis.motion import HypotheticalMotion, Motion

#: Values tried of a number whose scale the motion does not determine: three a decade over four of them.
N_START = 12


class ActionOrder(IntEnum):
    """In what order hypotheses act: from the drive to the link, whatever order they were found in.

    What no torque enters comes first. A limit is the same before a delay and after it, but before it the torque is
    as sharp as asked for. What acts on the torque does so before columns are made of it. What the arm is known to
    resist with is taken out in the end.
    """

    BACKLASH = auto()
    ARM = auto()
    GAIN = auto()
    LIMIT = auto()
    LATENCY = auto()
    TWIST = auto()
    COLUMNS = auto()
    FRICTION = auto()
    SCALE = auto()
    GIVEN = auto()


def is_one(kind: EffectKind) -> bool:
    """Say whether a joint has one effect of a kind at most, as between torque and link."""
    return kind.place in ("drive", "transmission")


class Hypothesis(ABC):
    """One effect of the catalogue, somewhere.

    The numbers in which the torque is not linear are called ``psi``; the factors of the columns are found by
    least squares together with the base parameters.

    Parameters
    ----------
    kind : EffectKind
    joints : tuple of int
        From 0; empty for effects of the whole arm.
    """

    #: How many columns it adds to the equation of motion.
    n_column = 0
    #: It acts at certain times or trials only, so these are sought over the whole run.
    is_event = False
    #: It is there in some trials or for some time only: other trials do not determine its parameters.
    is_intermittent = False
    #: Its gain shows only after a few iterations from a start near its neutral value.
    is_gradual = False
    #: The neutral psi, if the gradient there is informative; a gain below one scales all noise, too.
    nothing: tuple[float, ...] = ()
    #: Its columns are made of angles and their derivatives, noise included.
    is_noisy = True
    #: It changes how the equations turn with the acceleration.
    is_inertial = True
    #: When it acts, unless it adds columns.
    turn = ActionOrder.TWIST
    #: It is a factor of all that its joint resists with, noise included.
    is_gain = False
    #: It cuts the torque off.
    is_limit = False
    #: It makes the torque late, weak or unequal: what noise it lets through has to be computed.
    distorts = False
    #: It depends on how large the torque is that arrives.
    depends_on_torque = False
    #: Its factors say how large it is, whatever its parameters.
    is_sized_by_factors = False
    #: psi scales noise, or turns the columns among themselves: what noise makes of them depends on it.
    mixes_noise = False
    #: The share of psi over which is asked what a change of it makes: more where little changes jump.
    stride = SLOPE

    def __init__(self, kind: EffectKind, joints: Sequence[int]) -> None:
        self.kind = kind
        self.joints = tuple(joints)

    @property
    def key(self) -> tuple[str, tuple[int, ...]]:
        """What it is called: effect and joints."""
        return self.kind.name, self.joints

    @property
    def n_number(self) -> int:
        """How many numbers it is free to choose."""
        return self.n_column + len(self.low)

    @property
    def low(self) -> Floats:
        """Least values of psi, (n_psi,); none unless there is a psi."""
        return np.zeros(0)

    @property
    def high(self) -> Floats:
        """Greatest values of psi, (n_psi,)."""
        return np.zeros(0)

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values of psi to try first, (n_start, n_psi)."""
        return np.zeros((1, 0))

    def inside(self, psi: Floats) -> Floats:
        """Return psi (n_psi,) that acts as it does and lies within what is possible, where bounds don't say it."""
        return psi

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of places at which it is sought: values of psi, trials, moments."""
        return float(np.log(max(len(self.starts(motions)), 1)))

    def follow(self, links: Callable[[Motion, int], FreeLink | None], motions: Sequence[Motion]) -> None:
        """Take from a fitted model what moves a joint's link in a motion while no motor pulls on it."""
        return None

    @abstractmethod
    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion as it is if this hypothesis holds too."""

    def replaces(self, other: "Hypothesis") -> bool:
        """Say whether it takes the place of another one, for there is only one of its kind at a joint."""
        alike = is_one(self.kind) and self.kind.name == other.kind.name
        return alike and bool(set(self.joints) & set(other.joints))

    def psi_of(self, numbers: Floats) -> Floats:
        """Return psi (n_psi,) from the effect's own parameters, of a hypothesis without columns."""
        return np.array(numbers)

    @abstractmethod
    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the effect's own parameters, in the catalogue's order, from psi and the columns' factors."""

    def possible(self, psi: Floats, factors: Floats) -> bool:
        """Say whether the catalogue allows these numbers: friction brakes, springs pull back, masses weigh."""
        values = self.numbers(psi, factors)
        kinds = {parameter.name: parameter for parameter in self.kind.parameters}
        named = ((name.rstrip("0123456789").removesuffix("_"), name) for name in self.names)
        bounds = (kinds.get(name, kinds.get(stem)) for stem, name in named)
        return all(one is None or one.low <= value <= one.high for one, value in zip(bounds, values, strict=True))

    def standard_errors(self, of_fit: Floats, motions: Sequence[Motion]) -> Floats:
        """Return the standard errors of its numbers, (n_number,), with what motions hide from a fit."""
        return of_fit

    def determined(self, values: Floats, std: Floats) -> NDArray[np.bool_]:
        """Say which of its numbers (n_number,) are known, by their standard errors; NaN is no error."""
        return np.isfinite(std)

    def acts_in(self, motion: Motion) -> bool:
        """Say whether it acts in a motion at all."""
        return True

    def part_of(self, motion: Motion) -> object:
        """Return when it acts in a motion, in terms that compare equal where it does so alike."""
        return None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that `numbers` returns."""
        return tuple(parameter.name for parameter in self.kind.numbers)

    def units_at(self, joint: JointType) -> tuple[str, ...]:
        """Return units of the parameters that `numbers` returns, at joints of a type."""
        return tuple(parameter.unit_at(joint) for parameter in self.kind.numbers)

    def units(self, arm: Arm) -> tuple[str, ...]:
        """Return units of the parameters that `numbers` returns, at its joints."""
        return self.units_at(arm.joints[self.joints[0]].type if self.joints else "revolute")


#: A psi of less than this is moved as if it were this large: a milliradian, a millisecond.
LEAST_PSI = 1e-3


@dataclass(frozen=True)
class Model:
    """Hypotheses with the values of their psi."""

    hypotheses: tuple[Hypothesis, ...] = ()
    psi: tuple[Floats, ...] = ()

    def plus(self, hypothesis: Hypothesis, psi: Floats) -> "Model":
        """Return this model with one hypothesis more."""
        return Model((*self.hypotheses, hypothesis), (*self.psi, np.asarray(psi, dtype=np.float64)))

    def beside(self, other: "Model") -> "Model":
        """Return this model without what another one has in its stead."""
        return self.only([not any(one.replaces(own) for one in other.hypotheses) for own in self.hypotheses])

    def without(self, k: int) -> "Model":
        """Return this model without its k-th hypothesis."""
        return self.only([i != k for i in range(len(self.hypotheses))])

    def instead(self, k: int, hypothesis: Hypothesis) -> "Model":
        """Return this model with another hypothesis, of the same psi, in the place of its k-th."""
        return replace(self, hypotheses=(*self.hypotheses[:k], hypothesis, *self.hypotheses[k + 1 :]))

    def only(self, some: Sequence[bool]) -> "Model":
        """Return this model with some of its hypotheses."""
        keep = [i for i, one in enumerate(some) if one]
        return Model(tuple(self.hypotheses[i] for i in keep), tuple(self.psi[i] for i in keep))

    def at(self, flat: Floats) -> "Model":
        """Return this model with other values of psi, one after the other."""
        sizes = np.cumsum([len(one) for one in self.psi])[:-1]
        return replace(self, psi=tuple(np.split(np.asarray(flat, dtype=np.float64), sizes)))

    @property
    def flat(self) -> Floats:
        """All psi, one after the other."""
        return np.concatenate([np.zeros(0), *self.psi])

    def central_differences(self) -> Iterator[tuple["Model", "Model", float]]:
        """Yield for every psi the two models of its central difference, and the step between them."""
        for k, (hypothesis, psi) in enumerate(zip(self.hypotheses, self.psi, strict=True)):
            for i, value in enumerate(psi):
                step = hypothesis.stride * max(abs(float(value)), LEAST_PSI)
                ends = min(value + step, hypothesis.high[i]), max(value - step, hypothesis.low[i])
                one = np.arange(len(psi)) == i
                more, less = (self._with(k, np.where(one, end, psi)) for end in ends)
                yield more, less, float(ends[0] - ends[1])

    def _with(self, k: int, psi: Floats) -> "Model":
        return replace(self, psi=(*self.psi[:k], psi, *self.psi[k + 1 :]))

    @property
    def n_column(self) -> int:
        """How many columns its hypotheses add."""
        return sum(hypothesis.n_column for hypothesis in self.hypotheses)

    @property
    def is_event(self) -> bool:
        """Whether something in it happens at certain times or trials only."""
        return any(hypothesis.is_event for hypothesis in self.hypotheses)

    @property
    def cuts_off(self) -> bool:
        """Whether a drive has a limit."""
        return any(hypothesis.is_limit for hypothesis in self.hypotheses)

    @property
    def distorts(self) -> bool:
        """Whether a drive is late, weak or unequal."""
        return any(hypothesis.distorts for hypothesis in self.hypotheses)

    def undistorted(self) -> "Model":
        """Return this model without such drives."""
        return self.only([not hypothesis.distorts for hypothesis in self.hypotheses])

    @property
    def scales_only(self) -> bool:
        """Whether a gain in it does no more than scale what its joint resists with: nothing feels it."""
        return not any(hypothesis.depends_on_torque for hypothesis in self.hypotheses)

    def downstream(self) -> list[int]:
        """Return the places of its hypotheses in the order in which they act; of those with columns it stays."""
        gain = ActionOrder.SCALE if self.scales_only else ActionOrder.GAIN

        def turn(k: int) -> ActionOrder:
            hypothesis = self.hypotheses[k]
            if hypothesis.is_gain:
                return gain
            return ActionOrder.COLUMNS if hypothesis.n_column else hypothesis.turn

        return sorted(range(len(self.hypotheses)), key=turn)


#: Nothing beyond the base parameters.
BARE = Model()


@dataclass(frozen=True)
class Candidate:
    """A fitted model.

    Attributes
    ----------
    model : Model
        What was accepted before, and a hypothesis as its last.
    x : (n_factor,)
        Base parameters and the columns' factors.
    squares : (n_trial,)
        Sum of squares that is left in each trial, in units of the noise.
    """

    model: Model
    x: Floats
    squares: Floats

    @property
    def hypothesis(self) -> Hypothesis:
        """What was added last."""
        return self.model.hypotheses[-1]
