"""Which combinations of the standard parameters a motion can reveal, and an arm that has them.

Column after column of the regressor of many random motions is held against those before it (QR in a chosen
order, Gautier 1991). A column that depends on earlier ones adds its parameter to theirs; what is left over
are the base parameters. Links come in order from the base, inertia before first moments before mass, so the
DD arm yields the paper's eight: ``I1+m2*L1^2, m2*sx2, m2*sy2, I2, D1, D2, fc1, fc2``.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Arm, Floats, Friction
from arm.physical_links import links_with
from arm.regressor import regressor, standard_names

#: Random instants that stand for "any motion": eight equations a column, for each has one a joint and a joint has
#: twelve columns. The seed fixes them, the answer does not depend on it.
_INSTANTS = 100
#: A column whose new part is smaller than this share of itself depends on the columns before it.
_DEPENDENT = 1e-9
#: A smaller share than this of a column is what rounding leaves.
_ROUNDING = 1e-11


@dataclass(frozen=True)
class BaseParameters:
    """The identifiable combinations of an arm's standard parameters.

    Attributes
    ----------
    names : tuple of str
        Such as ``I1+m2*L1^2``.
    units : tuple of str
    independent : tuple of int
        The columns of the regressor that remain: ``Y @ p == Y[..., independent] @ (combination @ p)``.
    combination : (n_base, 12 * n_joint)
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    independent: tuple[int, ...]
    combination: Floats


def base_parameters(arm: Arm) -> BaseParameters:
    """Find the base parameters of an arm's geometry, gravity and friction.

    Parameters
    ----------
    arm : Arm

    Returns
    -------
    BaseParameters
        Inertial combinations first, then viscous, then Coulomb frictions.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (_INSTANTS, arm.n_joint))
    dq, ddq = rng.normal(size=(2, *q.shape))
    Y = regressor(arm, q, dq, ddq).reshape(-1, 12 * arm.n_joint)
    scale = np.linalg.norm(Y, axis=0)
    visible = np.flatnonzero(scale > _DEPENDENT * scale.max())

    R = scipy.linalg.qr(Y[:, visible] / scale[visible], mode="r")[0][: len(visible)]
    new = np.abs(np.diag(R)) > _DEPENDENT
    kept, folded = np.array(sorted(visible[new], key=_paper_order(arm))), visible[~new]
    combination = np.zeros((len(kept), Y.shape[1]))
    combination[np.arange(len(kept)), kept] = 1.0
    if len(folded):
        weights = scipy.linalg.lstsq(Y[:, kept] / scale[kept], Y[:, folded] / scale[folded])[0]
        weights[np.abs(weights) < _ROUNDING] = 0.0
        combination[:, folded] = weights * scale[folded] / scale[kept][:, None]

    names = _short_names(arm, visible)
    return BaseParameters(
        tuple(_combination_name(arm, names, kept[k], row) for k, row in enumerate(combination)),
        tuple(_unit(arm, column) for column in kept),
        tuple(int(column) for column in kept),
        combination,
    )


def with_base_values(arm: Arm, base: BaseParameters, values: Floats) -> Arm:
    """Return an arm whose links and friction have exactly these combinations.

    Parameters
    ----------
    arm : Arm
        Its own links say which of the many arms with these combinations is wanted: the nearest to them.
    base : BaseParameters
    values : (n_base,)

    Returns
    -------
    Arm
        A physically possible one where there is one; otherwise the nearest in the plain sense.
    """
    n = arm.n_joint
    inertial = np.asarray(base.independent) < 10 * n
    links = links_with(arm, base.combination[inertial][:, : 10 * n], np.asarray(values, dtype=float)[inertial])
    learnt = dict(zip(base.independent, np.asarray(values, dtype=float).tolist(), strict=True))
    joints = []
    for i, (joint, link) in enumerate(zip(arm.joints, links, strict=True)):
        friction = Friction(
            viscous_N_m_s=learnt.get(10 * n + i, joint.friction.viscous_N_m_s),
            coulomb_N_m=learnt.get(11 * n + i, joint.friction.coulomb_N_m),
            static_N_m=joint.friction.static_N_m,
        )
        joints.append(replace(joint, link=link, friction=friction))
    return replace(arm, joints=tuple(joints))


def _paper_order(arm: Arm) -> Callable[[int], tuple[int, bool, int]]:
    """Order columns as the paper's tables do: link by link, first moments before inertia; then friction."""
    inertial = 10 * arm.n_joint
    return lambda column: (min(column, inertial) // 10, column < inertial and column % 10 < 6, column)


def _short_names(arm: Arm, visible: NDArray[np.intp]) -> list[str]:
    """Call a link's inertia I1 rather than I1zz where no other component of it can be seen."""
    names = standard_names(arm.n_joint)
    for i in range(arm.n_joint):
        components = [column for column in visible if 10 * i <= column < 10 * i + 6]
        if components == [10 * i + 2]:
            names[10 * i + 2] = f"I{i + 1}"
    return names


def _combination_name(arm: Arm, names: list[str], kept: int, row: Floats) -> str:
    text = names[kept]
    for column in np.flatnonzero(row):
        if column != kept:
            sign, factor = _factor(arm, float(row[column]), int(column) // 10)
            text += (
                f"{sign}{names[column]}{factor}" if factor[:1] in ("", "*") else f"{sign}{factor}{names[column]}"
            )
    return text


def _factor(arm: Arm, weight: float, link: int) -> tuple[str, str]:
    """Return the sign and, where the weight is a product of lengths, its letters: ``*L1^2``."""
    sign = "+" if weight > 0 else "-"
    lengths = [("1", 1.0)]
    for i, joint in enumerate(arm.joints[: link + 1]):
        lengths += [(f"L{i + 1}", joint.a_m), (f"d{i + 1}", joint.d_m)]
    for a, (first, x) in enumerate(lengths):
        for second, y in lengths[a:]:
            for count in (1, 2):
                if math.isclose(abs(weight), count * abs(x * y), rel_tol=1e-6):
                    return sign, _letters(count, first, second)
    return sign, f"{abs(weight):.4g}*"


def _letters(count: int, first: str, second: str) -> str:
    letters = f"{first}^2" if first == second else "*".join(x for x in (first, second) if x != "1")
    letters = "" if letters == "1^2" else letters
    return "".join(f"*{x}" for x in (str(count) if count > 1 else "", letters) if x)


def _unit(arm: Arm, column: int) -> str:
    n = arm.n_joint
    if column < 10 * n:
        return "kg m^2" if column % 10 < 6 else ("kg m" if column % 10 < 9 else "kg")
    revolute = arm.joints[(column - 10 * n) % n].type == "revolute"
    if column < 11 * n:
        return "N m s/rad" if revolute else "N s/m"
    return "N m" if revolute else "N"
