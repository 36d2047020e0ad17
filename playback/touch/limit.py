"""How stiff and damped a coupling may be so that no energy comes out of it (docs/coupling.md, sections 3 and 4).

b is the damping that device and hand have of their own, B that of the coupling, K its stiffness, and T the
interval from one force to the next, with twice the delay between a place and the force that answers it.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from limbcal.errors import ConfigError


def sampled_interval(interval_s: float, delay_s: float) -> float:
    """Return the interval without delay that costs as much passivity as one with a delay.

    A force that is held for T lags the place by T/2 in the mean, and by the delay more.
    """
    return interval_s + 2.0 * delay_s


def stiffness_limit(device: float, damping: float, interval_s: float) -> float:
    """Return the stiffest coupling to an arm of any mass: ``4 sqrt(B) (sqrt(b) - sqrt(B)) / T`` [N/m].

    It is greatest, b/T, at ``B = b/4``.
    """
    return max(4.0 * math.sqrt(damping) * (math.sqrt(device) - math.sqrt(damping)) / interval_s, 0.0)


def damping_needed(stiffness: float, damping: float, interval_s: float) -> float:
    """Return the least b for a coupling: ``(K T)^2 / (16 B) + K T / 2 + B``, the inverse of `stiffness_limit`."""
    passed = stiffness * interval_s
    if passed == 0.0:
        return damping
    return passed * passed / (16.0 * damping) + passed / 2.0 + damping if damping > 0.0 else math.inf


def wall_limit(device: float, interval_s: float, damping: float = 0.0) -> float:
    """Return the stiffest wall, ``2 (b - B) / T``: the condition of Colgate and Schenkel [N/m]."""
    return max(2.0 * (device - damping) / interval_s, 0.0)


class Bound(NamedTuple):
    """Stiffest spring [N/m] and strongest damper [N s/m] that the arm's step follows, or those of rotation."""

    stiffness: float
    damping: float


UNBOUND = Bound(math.inf, math.inf)


def mass_limit(mass: float, step_s: float) -> Bound:
    """Return what the arm's step follows: ``m / h^2``, a sixth of a turn a step, and ``m / h``.

    With both at once an error is halved in two steps of Runge-Kutta. Alone, a damper may be 2.8 times and a spring
    8 times that before the step is unstable.
    """
    return Bound(mass / (step_s * step_s), mass / step_s)


@dataclass(frozen=True)
class Coupling:
    """What was asked of the coupling; what is given is as much of it as is passive.

    Attributes
    ----------
    stiffness, damping : float
        Between hand and touched point [N/m], [N s/m].
    device : float
        Damping that device and hand have of their own, at least [N s/m].
    max_force : float
        What the hand feels at most [N].
    turn_stiffness, turn_damping, turn_device, max_moment : float
        The same of rotation, where the device says its orientation [N m/rad], [N m s/rad], [N m].
    wall : (4,) tuple of float, optional
        Normal and offset: the hand is free where ``n.x >= c``.
    wall_stiffness : float, optional
        As stiff as is passive unless given [N/m].
    """

    stiffness: float = 400.0
    damping: float = 1.0
    device: float = 5.0
    max_force: float = 20.0
    turn_stiffness: float = 2.0
    turn_damping: float = 0.005
    turn_device: float = 0.02
    max_moment: float = 1.0
    wall: tuple[float, float, float, float] | None = None
    wall_stiffness: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises
        ------
        ConfigError
            With every mistake.
        """
        mistakes = [
            f"{name} is {value:g}, expected a number of at least 0"
            for name, value in vars(self).items()
            if isinstance(value, float | int) and not (math.isfinite(value) and value >= 0.0)
        ]
        if self.wall is not None:
            size = math.hypot(*self.wall[:3])
            if not (all(map(math.isfinite, self.wall)) and size > 0.0):
                mistakes.append(f"wall is {self.wall}, expected a normal that is not zero, and an offset")
            else:
                x, y, z, offset = (part / size for part in self.wall)
                object.__setattr__(self, "wall", (x, y, z, offset))
        if mistakes:
            raise ConfigError(mistakes)

    def within(self, interval_s: float, mass: Bound = UNBOUND, inertia: Bound = UNBOUND) -> "Coupling":
        """Return as much of the coupling, and then of the wall, as is passive at an interval.

        Where both are felt at once, the device's damping must do for both. ``mass`` and ``inertia`` are what the
        arm's step can follow, as `mass_limit` has it.
        """
        stiffness, damping = _passive(self.stiffness, self.damping, self.device, interval_s, mass)
        turn_stiffness, turn_damping = _passive(
            self.turn_stiffness, self.turn_damping, self.turn_device, interval_s, inertia
        )
        left = wall_limit(self.device, interval_s, damping_needed(stiffness, damping, interval_s))
        asked = math.inf if self.wall_stiffness is None else self.wall_stiffness
        return replace(
            self,
            stiffness=stiffness,
            damping=damping,
            turn_stiffness=turn_stiffness,
            turn_damping=turn_damping,
            wall_stiffness=0.0 if self.wall is None else min(asked, left),
        )


def _passive(
    stiffness: float, damping: float, device: float, interval_s: float, bound: Bound
) -> tuple[float, float]:
    """Return the coupling as it was asked for if it is passive; else with the damping that leaves most."""
    stiffness, damping = min(stiffness, bound.stiffness), min(damping, bound.damping)
    if damping <= device and stiffness <= stiffness_limit(device, damping, interval_s):
        return stiffness, damping
    best = min(device / 4.0, bound.damping)
    return min(stiffness, stiffness_limit(device, best, interval_s)), best
