"""Links by the segments of a person that they carry."""

import re

from arm.body.landmarks import limb_map
from arm.body.limbs import LIMBS
from arm.body.whole_body import body_map, is_whole_body
from arm.model import Arm
from limbcal.errors import ConfigError


def link_names(arm: Arm) -> list[str]:
    """Return a name of every link: its segment of a person, else its number."""
    names = [f"link {i + 1}" for i in range(arm.n_joint)]
    for segment, i in segments(arm).items():
        names[i] = segment
    return names


def segments(arm: Arm) -> dict[str, int]:
    """Return the link, from 0, that moves each segment of a person; of another arm none."""
    if is_whole_body(arm):
        return {name: part.link for name, part in body_map().parts.items()}
    if arm.name not in LIMBS:
        return {}
    return {name: part.link for name, part in limb_map(arm.name, arm.n_joint).parts.items()}


def link_named(text: str, arm: Arm) -> tuple[str, int]:
    """Return the plate and the link, from 0, of a text such as ``1=foot_right``.

    Raises
    ------
    ConfigError
        If there is no such link.
    """
    plate, _, link = text.partition("=")
    there = segments(arm)
    index = there.get(link.strip(), int(link) - 1 if re.fullmatch(r"\s*\d+\s*", link) else -1)
    if not plate.strip() or not 0 <= index < arm.n_joint:
        named = "".join(f", {name}" for name in there)
        raise ConfigError(f"--contact {text!r}: expected PLATE=LINK, a link being 1 to {arm.n_joint}{named}")
    return plate.strip(), index
