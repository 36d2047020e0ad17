"""The whole body as its limbs, pelvis and thorax, for a calibration limb by limb."""

from collections.abc import Mapping
from dataclasses import dataclass

from arm.body.landmarks import LimbMap
from arm.body.whole_body import BRANCHES, PELVIS_LINK, THORAX_LINK, human_body, limb_of_body
from arm.model import Arm, Body


@dataclass(frozen=True)
class LimbOfBody:
    """A limb of the body.

    Attributes
    ----------
    name : str
        Its preset, such as ``human-leg-right``.
    first : int
        Its first joint in the body, from 0.
    segment : str
        What it hangs on: ``pelvis`` or ``thorax``.
    arm : Arm
        The limb by itself.
    where : LimbMap
        Of the limb by itself.
    """

    name: str
    first: int
    segment: str
    arm: Arm
    where: LimbMap

    @property
    def is_leg(self) -> bool:
        """Whether it is a leg."""
        return self.segment == "pelvis"

    @property
    def begins(self) -> str:
        """The joint that it begins with: ``hip`` or ``girdle``."""
        return next(iter(self.where.centres))


@dataclass(frozen=True)
class BodyLimbs:
    """A body taken apart; links and joints count from 0.

    Attributes
    ----------
    lumbar : int
        First joint between pelvis and thorax.
    links : mapping of str to int
        By segment.
    limbs : tuple of LimbOfBody
    """

    lumbar: int
    links: Mapping[str, int]
    limbs: tuple[LimbOfBody, ...]


def body_with_limbs(person: Body) -> tuple[Arm, BodyLimbs]:
    """Return a person's body, and how it is made of limbs."""
    arm = human_body(person)
    links = {"pelvis": PELVIS_LINK, "thorax": THORAX_LINK}
    limbs = []
    for name, branch in BRANCHES.items():
        if branch.where is None:
            continue
        preset = f"human-{name.replace('_', '-')}"
        own = limb_of_body(person, name)
        segment = "pelvis" if arm.parents[branch.first] == PELVIS_LINK else "thorax"
        limbs.append(LimbOfBody(preset, branch.first, segment, own, branch.where))
        links |= {part: branch.first + one.link for part, one in branch.where.parts.items()}
    return arm, BodyLimbs(BRANCHES["trunk"].first, links, tuple(limbs))
