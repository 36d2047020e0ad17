"""One seed's arms and motions, and an input made of them."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from arm.model import Arm, Friction, Link
from benchmarks.contradictions.commands import Go
from benchmarks.contradictions.motions import Columns, arms, motion
from benchmarks.contradictions.verdicts import Right


@dataclass
class Case:
    """One input: how to run it, and what is right."""

    kind: str
    name: str
    run: Go
    right: Right
    result: str = field(default="")


Cases = Iterator[Case]


@dataclass(frozen=True)
class Drawn:
    """What a seed draws.

    Attributes
    ----------
    seed : int
    arm, several : Arm
        Of one, two or three joints; of two or three.
    learn, evaluate, other : Columns
        Motions of the arm to learn from and to evaluate on, and one of several joints.
    """

    seed: int
    arm: Arm
    several: Arm
    learn: Columns
    evaluate: Columns
    other: Columns

    @property
    def where(self) -> str:
        """What a case is called."""
        return f"{self.arm.name}, seed {self.seed}"

    @property
    def blank(self) -> Arm:
        """The arm without masses or friction."""
        joints = tuple(replace(joint, link=Link(), friction=Friction()) for joint in self.arm.joints)
        return replace(self.arm, joints=joints)


def draw(seed: int) -> Drawn:
    """Return a seed's arms and motions."""
    arm, several = arms()[seed % 3], arms()[1 + seed % 2]
    return Drawn(seed, arm, several, motion(arm, seed), motion(arm, seed + 50), motion(several, seed + 20))
