"""Which parameters of eq. (1) a person's motion determines, and how far they differ from person to person.

A line in space has four numbers, and a joint's zero takes up one of them. So two neighbouring axes that nearly
meet have three numbers: the twist ``alpha``, the distance ``a`` and the place ``d`` of their common normal.
Two that are nearly parallel, knee and ankle, have no common normal that stays in place; there the paper's ``beta``
takes the place of ``d``. Axes of a ball joint meet at right angles by choice; and where the last of them points
within the segment is a choice too, so that only the distance to the next axis is left. All other numbers are
gauge.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from arm.chain import chain_of
from arm.marker_kinematics import (
    ALPHA,
    BASE_POSITION,
    BASE_ROTATION,
    BETA,
    HANG_X,
    A,
    D,
    Integers,
)
from arm.model import Arm, Floats, Joint

_NAMES = {ALPHA: "alpha", A: "a", D: "d", BETA: "beta", BASE_POSITION: "base", BASE_ROTATION: "base_turn"}
_THETA_OFFSET = 4  # a column of `arm.chain.Chain.geometry` too, never free
_FIELDS = {ALPHA: "alpha_rad", A: "a_m", D: "d_m", BETA: "beta_rad", _THETA_OFFSET: "theta_offset_rad"}
#: Standard deviations over people, assumed: of the angle between axes (the elbow's carrying angle and the ankle's
#: obliquity are 10° off a right angle; Isman and Inman 1969 give 9° sd of the subtalar axis), of how far axes pass
#: each other by [m], of the share of a table's length, and of where a table or a regression has a centre [m].
TWIST_RAD, PASSES_M, LENGTH_SHARE, CENTRE_M = 0.15, 0.01, 0.1, 0.05


@dataclass(frozen=True)
class FreeGeometry:
    """The free numbers of a limb, with their prior.

    Attributes
    ----------
    what : (n_free, 2) int64
        Kind and joint (or axis) from 0, as `arm.marker_kinematics.free_slopes` takes them.
    names : tuple of str
        Such as ``d3``, ``alpha4``, ``base_x``.
    std : (n_free,) [rad or m]
        Of the prior about the start.
    """

    what: Integers
    names: tuple[str, ...]
    std: Floats

    @property
    def units(self) -> list[str]:
        """Unit of each."""
        return ["rad" if kind in (ALPHA, BETA, BASE_ROTATION) else "m" for kind in self.what[:, 0]]


@dataclass(frozen=True)
class Geometry:
    """The numbers of a chain: what a fit changes of it.

    Attributes
    ----------
    numbers : (n_joint, 5)
        alpha, a, d, beta, theta offset.
    base_R : (3, 3)
        Frame 0's axes as columns, in the segment that carries it.
    base_p : (3,) [m]
    revolute : (n_joint,) bool
    parent : (n_joint,) int64
    hang : (n_joint, 4)
        Which link each joint hangs on, and where, as `arm.chain.Chain` has them.
    """

    numbers: Floats
    base_R: Floats
    base_p: Floats
    revolute: NDArray[np.bool_]
    parent: Integers
    hang: Floats

    def moved(self, free: FreeGeometry, step: Floats) -> "Geometry":
        """Return the geometry a step further; a turn of the base is about frame 0's axes."""
        numbers, p, hang = self.numbers.copy(), self.base_p.copy(), self.hang.copy()
        turn = np.zeros(3)
        for (kind, i), value in zip(free.what, step, strict=True):
            if kind == BASE_POSITION:
                p[i] += value
            elif kind == BASE_ROTATION:
                turn[i] += value
            elif kind >= HANG_X:
                hang[i, 1 + kind - HANG_X] += value
            else:
                numbers[i, kind] += value
        R = self.base_R @ Rotation.from_rotvec(turn).as_matrix()
        return replace(self, numbers=numbers, base_R=R, base_p=p, hang=hang)

    def away(self, free: FreeGeometry, other: "Geometry") -> Floats:
        """Return the free numbers less those of another geometry, (n_free,)."""
        turn = Rotation.from_matrix(other.base_R.T @ self.base_R).as_rotvec()
        p, hang, numbers = self.base_p - other.base_p, self.hang - other.hang, self.numbers - other.numbers
        found = np.empty(len(free.what))
        for k, (kind, i) in enumerate(free.what):
            if kind in (BASE_POSITION, BASE_ROTATION):
                found[k] = (p if kind == BASE_POSITION else turn)[i]
            else:
                found[k] = hang[i, 1 + kind - HANG_X] if kind >= HANG_X else numbers[i, kind]
        return found

    def joints(self, arm: Arm) -> tuple[Joint, ...]:
        """Return an arm's joints with these numbers."""
        found = []
        for joint, row, hang in zip(arm.joints, self.numbers, self.hang, strict=True):
            one = replace(joint, **{name: float(row[kind]) for kind, name in _FIELDS.items()})  # type: ignore[arg-type]
            if joint.parent_position_m is not None:
                one = replace(one, parent_position_m=(float(hang[1]), float(hang[2]), float(hang[3])))
            found.append(one)
        return tuple(found)


def geometry_of(arm: Arm) -> Geometry:
    """Return an arm's numbers, frame 0 at the origin."""
    chain = chain_of(arm)
    return Geometry(chain.geometry.copy(), np.eye(3), np.zeros(3), chain.revolute, chain.parent, chain.hang.copy())


def free_geometry(arm: Arm, centre_std_m: float, length_std_m: Sequence[float]) -> FreeGeometry:
    """Return what is free of a preset's geometry.

    Parameters
    ----------
    arm : Arm
        As `arm.body.limbs.limb` builds it, of its seven, nine (an arm) or six (a leg) joints.
    centre_std_m : float
        How well the place of frame 0 in its segment is known beforehand.
    length_std_m : sequence of two or three floats
        How well the lengths are, in their order: (girdle,) upper arm and forearm, or thigh and shank.
    """
    is_leg = arm.n_joint == 6
    k = 0 if is_leg else arm.n_joint - 7
    rows: list[tuple[int, int, float]] = [(BASE_POSITION, axis, centre_std_m) for axis in range(3)]
    if k:  # where the girdle's axes stand in the thorax
        rows += [(BASE_ROTATION, axis, TWIST_RAD) for axis in range(2)]
    return of_rows(rows + limb_rows(is_leg, k, length_std_m, lower_turns=not is_leg))


def limb_rows(
    is_leg: bool, ball: int, length_std_m: Sequence[float], lower_turns: bool
) -> list[tuple[int, int, float]]:
    """Return kind, joint and prior standard deviation of what is free of a limb, without where it begins.

    Parameters
    ----------
    is_leg : bool
    ball : int
        Its hip's or shoulder's first joint, from 0.
    length_std_m : sequence of float
        As `free_geometry` takes them: three of an arm with a girdle, two otherwise.
    lower_turns : bool
        Whether the lower segment turns about its long axis, as every forearm does.
    """
    k, (*girdle, upper, lower) = ball, length_std_m
    rows = [(A, k - 1, girdle[0]), (D, k - 1, 2.0 * PASSES_M)] if girdle else []  # the shoulder on the girdle
    rows += [(D, k + 2, upper)]
    if not lower_turns:
        rows += [(A, k + 3, lower), (ALPHA, k + 4, TWIST_RAD), (BETA, k + 4, TWIST_RAD)]
        return rows + [(D, k + 4, PASSES_M), (A, k + 4, PASSES_M), (ALPHA, k + 5, 2.0 * TWIST_RAD)]
    rows += [(ALPHA, k + 3, TWIST_RAD), (A, k + 3, PASSES_M), (ALPHA, k + 4, TWIST_RAD)]
    rows += [(D, k + 4, lower), (A, k + 4, PASSES_M), (ALPHA, k + 5, TWIST_RAD)]
    last = 2.0 * TWIST_RAD if is_leg else TWIST_RAD
    return rows + [(D, k + 5, PASSES_M), (A, k + 5, PASSES_M), (ALPHA, k + 6, last)]


def of_rows(rows: Sequence[tuple[int, int, float]]) -> FreeGeometry:
    """Return the free numbers of rows of kind, joint (or axis) from 0, and prior standard deviation."""
    what: NDArray[np.int64] = np.array([(kind, i) for kind, i, _ in rows], dtype=np.int64)
    return FreeGeometry(what, tuple(_name(kind, i) for kind, i, _ in rows), np.array([std for *_, std in rows]))


def _name(kind: int, i: int) -> str:
    if kind in (BASE_POSITION, BASE_ROTATION):
        return f"{_NAMES[kind]}_{'xyz'[i]}"
    return f"parent_position{i + 1}_{'xyz'[kind - HANG_X]}" if kind >= HANG_X else f"{_NAMES[kind]}{i + 1}"
