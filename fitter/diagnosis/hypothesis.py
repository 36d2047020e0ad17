"""A hypothesis: one effect at some joints, with numbers that are sought on a grid first and then refined."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from enum import IntEnum, auto

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.diagnosis.least_squares import SLOPE
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: Values tried of a number whose scale the motion does not tell: three a decade over four of them.
N_START = 12
#: A small turn, from which slopes lead to a larger one: under a degree [rad].
SMALL_TURN = 0.01


class Turn(IntEnum):
    """In what order hypotheses act: from the drive to the link, whatever order they were found in.

    What no torque enters comes first. A limit is the same before a delay and after it, but before it the torque is
    as sharp as asked for. What acts on the torque does so before columns are made of it.
    """

    PLAY = auto()
    ARM = auto()
    GAIN = auto()
    LIMIT = auto()
    LATENESS = auto()
    TWIST = auto()
    COLUMNS = auto()
    FRICTION = auto()
    SCALE = auto()


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
    #: It is there in some trials or for some time only: others tell nothing of its numbers.
    comes_and_goes = False
    #: A few steps from a start near nothing tell what it can explain; the start itself does not.
    is_gradual = False
    #: The psi at which it is nothing, if slopes there tell as much of it; what is weak scales all noise, too.
    nothing: tuple[float, ...] = ()
    #: Its columns are made of angles and their derivatives, noise included.
    is_noisy = True
    #: It changes how the equations turn with the acceleration.
    is_inertial = True
    #: When it acts, unless it adds columns.
    turn = Turn.TWIST
    #: It is a factor of all that its joint resists with, noise included.
    is_gain = False
    #: It cuts the torque off.
    is_limit = False
    #: It makes the torque late, weak or unequal: what noise it lets through has to be computed.
    distorts = False
    #: It depends on how large the torque is that arrives.
    feels_torque = False
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

    @abstractmethod
    def act(self, view: View, psi: Floats) -> View:
        """Return a motion as it is if this hypothesis holds too."""

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

    def hidden(self, motions: Sequence[Motion], values: Floats) -> Floats:
        """Return standard errors, (n_number,), of what these motions hide from any fit, such as times at rest."""
        return np.zeros(len(values))

    def part_of(self, motion: Motion) -> object:
        """Return when it acts in a motion, in terms that compare equal where it does so alike."""
        return None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that `numbers` returns."""
        return tuple(parameter.name for parameter in self.kind.parameters)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters that `numbers` returns."""
        return tuple(parameter.unit for parameter in self.kind.parameters)
