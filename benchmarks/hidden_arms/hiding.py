"""What it takes to hide something in an arm: an effect that is drawn at random but for its strength.

Every effect has a scale of its own, so that a strength of about 0.1 is visible and 1 is gross.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.hidden_arms.hidden_arm import ACTIONS, Floats, HiddenArm, Recorded

Rng = np.random.Generator


#: One entry of an arm file's effects: its parameters, and the joints (from 1) that it acts on.
Entry = dict[str, Any]


@dataclass(frozen=True)
class Bench:
    """The sizes of a case."""

    rate_hz: float = 500.0
    trial_s: float = 6.75
    rest_s: float = 0.5
    learning: int = 5
    evaluating: int = 17
    span_rad: float = 1.2
    step_hz: float = 4000.0

    @property
    def trials(self) -> int:
        """Number of trials."""
        return self.learning + self.evaluating


@dataclass(frozen=True)
class Scene:
    """The arm with nothing hidden in it, and how it moves in some trials; what sizes are drawn by.

    ``ref`` (n_sample, n) is the target of all trials.
    """

    arm: HiddenArm
    motion: Recorded
    ref: Floats
    bench: Bench

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.arm.links)

    @property
    def level(self) -> bool:
        """The arm's plane is."""
        return not self.arm.gravity.any()

    @property
    def torque(self) -> Floats:
        """Root mean square of each joint's torque (n,)."""
        return np.sqrt(np.mean(self.motion.u**2, axis=0))

    @property
    def speed(self) -> Floats:
        """Root mean square of each joint's velocity (n,)."""
        return np.sqrt(np.mean(self.motion.link_dq**2, axis=0))


@dataclass(frozen=True)
class Hiding:
    """An effect that is drawn but for its strength.

    Attributes
    ----------
    name : str
    joints : tuple of int
        From 0; empty for effects of the whole arm.
    hide : callable
        ``hide(arm, strength)`` is the arm with it.
    entries : callable
        ``entries(strength)`` are its true parameters, as an arm file has them.
    most : float
        No stronger than this.
    start : float
        Where to begin to look.
    variables : tuple of str
        What it depends on, where it is in no catalogue.
    learning_only : bool
        It happens in learning trials, so its size is that in them.
    """

    name: str
    joints: tuple[int, ...]
    hide: Callable[[HiddenArm, float], HiddenArm]
    entries: Callable[[float], list[Entry]]
    most: float = 1.0
    start: float = 0.1
    variables: tuple[str, ...] = ()
    learning_only: bool = False


def with_action(arm: HiddenArm, name: str, joint: int, *numbers: float) -> HiddenArm:
    row = np.zeros((1, 6))
    row[0, : 2 + len(numbers)] = ACTIONS[name], joint, *numbers
    return arm._replace(acting=np.vstack([arm.acting, row]))


def with_cells(table: Floats, rows: tuple[int, ...], column: int, value: float) -> Floats:
    changed = table.copy()
    changed[list(rows), column] = value
    return changed


def at_joint(
    name: str, joint: int, numbers: Callable[[float], tuple[float, ...]], names: str, **rest: Any
) -> Hiding:
    """Return an effect of one joint whose numbers, in the simulation's order, go by ``names``."""

    def entries(s: float) -> list[Entry]:
        return [{"joints": [joint + 1], "parameters": dict(zip(names.split(), numbers(s), strict=False))}]

    return Hiding(name, (joint,), lambda arm, s: with_action(arm, name, joint, *numbers(s)), entries, **rest)


def either_way(rng: Rng) -> float:
    return float(rng.choice([-1.0, 1.0]))


def log_uniform(rng: Rng, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
