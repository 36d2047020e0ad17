"""The numbers of an extended arm, fitted to its motion: what an equation fit leaves to be gained in prediction.

The diagnosis fits the equation of motion. Where what counts is how far a simulation goes astray, the same numbers
(centres of mass, inertias, frictions, those of the effects) are moved from there by nonlinear least squares until
the simulated motion fits best. No cause is added or taken away.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.optimize

from arm.effects.catalogue import catalogue
from arm.model import Arm, Floats, Vector3

#: Inertia about the joint's own axis, of xx, yy, zz, xy, xz, yz.
_ABOUT_AXIS = 2
#: Steps of the search: each takes one simulation a number.
_ROUNDS = 15
#: Numbers that say where an effect is, and are not to be moved.
_PLACES = ("side", "phase_rad", "start_s", "since_s", "trials")


@dataclass(frozen=True)
class Number:
    """One number of an arm that may be moved.

    Attributes
    ----------
    value, scale, low, high : float
    put : callable
        Returns the arm that has another value.
    of : tuple, optional
        The effect's place in the arm, and the parameter.
    """

    value: float
    scale: float
    low: float
    high: float
    put: Callable[[Arm, float], Arm]
    of: tuple[int, str] | None = None


@dataclass(frozen=True)
class Refined:
    """An arm whose motion fits best.

    Attributes
    ----------
    arm : Arm
    square : float
        Mean squared error that is left [rad^2].
    std : mapping from (effect's place in the arm, parameter) to float
        Standard errors, by a sandwich estimate over the stretches that were simulated.
    """

    arm: Arm
    square: float
    std: Mapping[tuple[int, str], float]


def refined(
    arm: Arm, errors: Callable[[Arm], Floats], known_inertia: bool = False, rounds: int = _ROUNDS
) -> Refined:
    """Return the arm whose simulated motion fits best.

    Parameters
    ----------
    arm : Arm
        To start from.
    errors : callable
        Simulated less measured angles of an arm, (n_stretch, …) or flat.
    known_inertia : bool
        The last link's inertia stays: nothing else tells the scale of an arm that swings freely.
    rounds : int
    """
    numbers = _numbers(arm, known_inertia)
    scale = np.array([number.scale for number in numbers])

    def moved(x: Floats) -> Arm:
        changed = arm
        for number, value in zip(numbers, x * scale, strict=True):
            changed = number.put(changed, float(value))
        return changed

    start = np.array([number.value for number in numbers]) / scale
    low, high = (np.array([getattr(number, side) for number in numbers]) / scale for side in ("low", "high"))
    found = scipy.optimize.least_squares(
        lambda x: np.nan_to_num(errors(moved(x)).ravel(), nan=10.0, posinf=10.0, neginf=-10.0),
        np.clip(start, low + 1e-9, high - 1e-9),
        bounds=(low, high),
        diff_step=1e-3,
        x_scale=1.0,
        max_nfev=rounds,
    )
    count = len(np.atleast_2d(errors(arm)))
    inverse = np.linalg.pinv(found.jac.T @ found.jac)
    scores = [J.T @ r for J, r in zip(np.split(found.jac, count), np.split(found.fun, count), strict=True)]
    covariance = inverse @ sum(np.outer(g, g) for g in scores) @ inverse
    std = scale * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    named = {number.of: float(one) for number, one in zip(numbers, std, strict=True) if number.of}
    return Refined(moved(found.x), float(np.mean(found.fun**2)), named)


def _numbers(arm: Arm, known_inertia: bool) -> list[Number]:
    numbers: list[Number] = []
    mass = sum(joint.link.mass_kg for joint in arm.joints) or 1.0
    for i, joint in enumerate(arm.joints):
        size = abs(joint.a_m) or 0.1
        com = joint.link.com_m
        # A link without mass has its moments in nothing that could be moved.
        if joint.link.mass_kg > 1e-6 * mass:
            numbers += [Number(com[k], size, -np.inf, np.inf, _com(i, k)) for k in (0, 1)]
        if not (known_inertia and i == arm.n_joint - 1):
            inertia = joint.link.inertia_kg_m2[_ABOUT_AXIS]
            numbers.append(Number(inertia, max(abs(inertia), 1e-6), 0.0, np.inf, _inertia(i)))
        for name in ("viscous_N_m_s", "coulomb_N_m"):
            value = getattr(joint.friction, name)
            if value != 0.0:
                numbers.append(Number(max(value, 0.0), abs(value), 0.0, np.inf, _friction(i, name)))
    for k, effect in enumerate(arm.effects):
        for parameter in catalogue()[effect.name].parameters:
            value = effect.parameters.get(parameter.name)
            if isinstance(value, float) and parameter.name not in _PLACES:
                at = max(abs(value), 1e-9)
                numbers.append(
                    Number(
                        value, at, parameter.low, parameter.high, _effect(k, parameter.name), (k, parameter.name)
                    )
                )
    return numbers


def _com(i: int, k: int) -> Callable[[Arm, float], Arm]:
    def put(arm: Arm, value: float) -> Arm:
        x, y, z = arm.joints[i].link.com_m
        moved: Vector3 = (value, y, z) if k == 0 else (x, value, z)
        return _joint(arm, i, link=replace(arm.joints[i].link, com_m=moved))

    return put


def _inertia(i: int) -> Callable[[Arm, float], Arm]:
    def put(arm: Arm, value: float) -> Arm:
        xx, yy, _, xy, xz, yz = arm.joints[i].link.inertia_kg_m2
        return _joint(arm, i, link=replace(arm.joints[i].link, inertia_kg_m2=(xx, yy, value, xy, xz, yz)))

    return put


def _friction(i: int, name: str) -> Callable[[Arm, float], Arm]:
    def put(arm: Arm, value: float) -> Arm:
        return _joint(arm, i, friction=replace(arm.joints[i].friction, **{name: value}))

    return put


def _effect(k: int, name: str) -> Callable[[Arm, float], Arm]:
    def put(arm: Arm, value: float) -> Arm:
        effect = replace(arm.effects[k], parameters={**arm.effects[k].parameters, name: value})
        return replace(arm, effects=(*arm.effects[:k], effect, *arm.effects[k + 1 :]))

    return put


def _joint(arm: Arm, i: int, **changes: object) -> Arm:
    joint = replace(arm.joints[i], **changes)  # type: ignore[arg-type]
    return replace(arm, joints=(*arm.joints[:i], joint, *arm.joints[i + 1 :]))
