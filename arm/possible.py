"""What in an arm cannot be: masses below zero, inertias of no body, friction or a law that drives.

A fit may write such an arm, and its errors may allow it: it is questioned, not refused.
"""

from collections.abc import Iterator

import numpy as np

from arm.model import Arm, Estimate, Floats, Link

#: What rounding to three digits leaves of an inertia, as a share of the largest.
_ROUNDING = 1e-3
#: A joint this slow is taken to be at rest [rad/s or m/s].
_REST = 0.02
#: Standard errors below zero up to which a friction is within its error.
_WITHIN = 2.0


def impossibilities(arm: Arm) -> Iterator[tuple[str, str]]:
    """Yield what an arm cannot have: the field, and a sentence that names it."""
    for k, joint in enumerate(arm.joints):
        yield from _of_link(f"joint[{k}].link", joint.link)
        yield from _of_friction(arm, k)
    yield from _of_law(arm)


def why_it_runs_away(arm: Arm) -> str:
    """Return what of an arm makes its simulation run away, or what to look at where nothing is impossible."""
    found = "; ".join(sentence for _, sentence in impossibilities(arm))
    return found or "expected masses that an arm can have, and gains and a step that go with them"


def _of_link(name: str, link: Link) -> Iterator[tuple[str, str]]:
    if link.mass_kg < 0.0:
        yield _said(f"{name}.mass_kg", f"{link.mass_kg:g}", "no body has such a mass", "a number not below 0")
        return
    least, triangle = _about_centre(link)
    shown = f"[{', '.join(f'{x:g}' for x in link.inertia_kg_m2)}]"
    if least < 0.0:
        why = f"about the centre of mass, {link.mass_kg:g} kg at com_m, it is below zero"
        yield _said(f"{name}.inertia_kg_m2", shown, why, "more, about the joint axis' origin")
    elif triangle < 0.0:
        why = "one principal moment about the centre of mass is larger than the other two together"
        yield _said(f"{name}.inertia_kg_m2", shown, why, "the inertia of a body")


def _about_centre(link: Link) -> tuple[float, float]:
    """Return the least principal moment about the centre of mass, and what the two least have above the largest.

    Moments that are zero are not given: a planar arm needs one of them only. Both are beyond rounding.
    """
    xx, yy, zz, xy, xz, yz = link.inertia_kg_m2
    about_origin, s = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), np.array(link.com_m)
    with np.errstate(over="ignore", invalid="ignore"):
        centre: Floats = about_origin - link.mass_kg * (s @ s * np.eye(3) - np.outer(s, s))
    if not np.isfinite(centre).all():  # too large for any unit, which is a question of its own
        return 0.0, 0.0
    rounding = _ROUNDING * float(np.abs(about_origin).max())
    given = np.diag(about_origin) != 0.0
    if not given.all():
        return float(np.min(np.diag(centre)[given], initial=0.0)) + rounding, 0.0
    moments = np.linalg.eigvalsh(centre)
    return float(moments[0]) + rounding, float(moments[0] + moments[1] - moments[2]) + rounding


def _of_friction(arm: Arm, k: int) -> Iterator[tuple[str, str]]:
    """Yield the frictions that drive a joint when it moves, the law's damping and their errors allowed for."""
    friction, control = arm.joints[k].friction, arm.control
    damped = abs(control.kv[k]) if control.law in ("pd", "pda") else 0.0  # its sign is a doubt of its own
    viscous = friction.viscous_N_m_s + _reach(arm, f"D{k + 1}") + damped
    coulomb = friction.coulomb_N_m + _reach(arm, f"fc{k + 1}")
    for name, value, drives in (
        ("viscous_N_m_s", friction.viscous_N_m_s, viscous < 0.0),
        ("coulomb_N_m", friction.coulomb_N_m, coulomb + max(viscous, 0.0) * _REST < 0.0),
        ("static_N_m", friction.static_N_m, True),
    ):
        if value < 0.0 and drives:
            field = f"joint[{k}].friction.{name}"
            yield _said(field, f"{value:g}", "friction below zero drives the joint", "a number not below 0")


def _reach(arm: Arm, name: str) -> float:
    std = arm.base_parameters.get(name, Estimate(0.0)).std
    return _WITHIN * std if np.isfinite(std) else 0.0


def _of_law(arm: Arm) -> Iterator[tuple[str, str]]:
    """Yield the gains of a sign that pushes a joint away from its target or on in the way it goes."""
    control = arm.control
    if control.law == "measured":
        return
    for k, kp in enumerate(control.kp):
        if kp < 0.0:
            why = "in tau = kp (ref - q) it pushes the joint away from its target"
            yield _said(f"control.kp[{k}]", f"{kp:g}", why, "a gain above 0")
    for k, kv in enumerate(control.kv if control.law in ("pd", "pda") else ()):
        if kv > 0.0:
            why = "in tau = kp (ref - q) + kv dq it drives the joint on, for a gain that damps is below zero"
            yield _said(f"control.kv[{k}]", f"{kv:g}", why, "a gain below 0")


def _said(field: str, shown: str, why: str, expected: str) -> tuple[str, str]:
    return field, f"{field} is {shown}: {why}; expected {expected}"
