"""Whether masses and friction can have what was learnt, and the best answer that they can have.

Base parameters are combinations. They are possible if *some* links with positive definite pseudo-inertias
(Traversaro 2016) have them, and every friction brakes. The paper's own arm fails this: D1 and fc2 are negative.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats, Friction, Link
from arm.physical_links import is_possible
from arm.regressor import standard_parameters
from fitter.dynamics.feasible_least_squares import least_squares_possible
from fitter.dynamics.torque_problem import TorqueProblem
from fitter.search.whitened import whiten

#: What stands for a link whose own parameters are not possible: a rod of 1 kg.
_ROD = np.array([0.01, 0.02, 0.02, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 1.0])
#: A value this few standard errors away from a possible one may as well be possible.
WITHIN_ERROR = 2.0
#: The search ends this near to the best, in units of the noise's variance and of the torque's power; and in units
#: of standard errors, or of the values themselves, where the nearest possible values are sought.
_NEAR_NOISE, _NEAR_POWER = 1e-6, 1e-13
_NEAR_STD, _NEAR_VALUE = 1e-7, 1e-11
#: Values are impossible if the nearest possible ones are further away than this, in the same units.
_FAR_STD, _FAR_VALUE = 1e-2, 1e-5
#: Standard errors are not taken to be smaller than this fraction of the value: rounding.
_LEAST_STD = 1e-6
#: Of a combination of parameters that hang together, as a share of theirs: rounding again.
_LEAST_VARIANCE = 1e-9
#: What the data does not determine is drawn to its prior with this weight relative to the search's margin: by far
#: weaker than noise draws, by far stronger than the barrier.
_PULL = 1e4
#: What is held stays with this weight, relative to the torque's power.
_HOLD = 1e8
#: A column that adds less than this, squared, to the free ones is not determined by the data.
_NEW_PART = 1e-8


@dataclass(frozen=True)
class Violation:
    """A base value that no arm can have.

    Attributes
    ----------
    name : str
        The parameter; of inertial values, which are impossible together, the one that must move most, in units of
        its standard error.
    value, nearest : float
        As learnt, and in the nearest possible arm.
    std_away : float or None
        How many standard errors lie between; None where they are not known.
    sentence : str
    """

    name: str
    value: float
    nearest: float
    std_away: float | None
    sentence: str

    @property
    def within_error(self) -> bool:
        """Whether the error explains it: the value may be possible after all."""
        return self.std_away is not None and self.std_away <= WITHIN_ERROR

    def document(self) -> dict[str, object]:
        """Return the violation as it stands in a JSON document."""
        return {
            "parameter": self.name,
            "value": self.value,
            "nearest": self.nearest,
            "std_away": self.std_away,
            "within_error": self.within_error,
            "sentence": self.sentence,
        }


def violations(
    arm: Arm, base: BaseParameters, values: Floats, covariance: Floats | None = None
) -> list[Violation]:
    """Return which base values no physical arm can have.

    Parameters
    ----------
    arm : Arm
        Its own links are where possible ones are sought from.
    base : BaseParameters
    values : (n_base,)
    covariance : (n_base, n_base), optional
        Of the values. A parameter with NaN on the diagonal was not learnt: if it is inertial it is taken to be
        whatever makes the others possible.

    Returns
    -------
    list of Violation
        Frictions below zero, then at most one for the inertial values together.
    """
    std = None if covariance is None else np.sqrt(np.diag(covariance))
    if std is None or not np.isfinite(std).any():
        std, covariance = None, None
    found = []
    for k in np.flatnonzero(~_inertial(arm, base)).tolist():
        if values[k] < 0.0:
            away = None if std is None or not std[k] > 0.0 else float(-values[k] / std[k])
            said = f"{base.names[k]} = {values[k]:.4g} {base.units[k]} pushes instead of braking"
            found.append(_violation(base.names[k], float(values[k]), 0.0, away, said))
    inertial = np.flatnonzero(_inertial(arm, base))
    if not len(inertial):
        return found
    unit = np.maximum(np.abs(values[inertial]), 1e-3 * max(1e-12, float(np.abs(values[inertial]).max())))
    if covariance is None or std is None:
        scale, root = unit, np.diag(1.0 / unit)
        near, far = _NEAR_VALUE, _FAR_VALUE
    else:
        scale = np.maximum(std[inertial], _LEAST_STD * unit)
        root = _inverse_root(covariance[np.ix_(inertial, inertial)], scale)
        near, far = _NEAR_STD, _FAR_STD
    C = base.combination[inertial][:, : 10 * arm.n_joint]
    optimum = least_squares_possible(root @ C, root @ values[inertial], nominal_links(arm), np.ones(0), near)
    if np.sqrt(optimum.cost) <= far:
        return found
    nearest = C @ optimum.links.ravel()
    moved = np.nan_to_num(np.abs(nearest - values[inertial]) / scale)
    most = int(np.argmax(moved))
    k = int(inertial[most])
    said = f"{base.names[k]} = {values[k]:.4g} {base.units[k]} and the other masses and inertias fit no real links"
    away = None if std is None else float(moved[most])
    return [*found, _violation(base.names[k], float(values[k]), float(nearest[most]), away, said)]


def nearest_possible(arm: Arm, base: BaseParameters, values: Floats) -> Arm:
    """Return the arm that can exist whose inertial parameters are nearest to some values, each in its own size.

    Parameters
    ----------
    arm : Arm
        Of the many arms with these parameters the nearest to it is taken.
    base : BaseParameters
    values : (n_base,)
        NaN where nothing is known of one. Frictions below zero become zero.

    Raises
    ------
    NotConverged
        If no such arm was found.
    """
    inertial = np.flatnonzero(_inertial(arm, base) & np.isfinite(values))
    wanted = values[inertial]
    unit = np.maximum(np.abs(wanted), 1e-3 * max(1e-12, float(np.abs(wanted).max(initial=0.0))))
    C = base.combination[inertial][:, : 10 * arm.n_joint] / unit[:, None]
    optimum = least_squares_possible(C, wanted / unit, nominal_links(arm), np.ones(0), _NEAR_VALUE)
    braking = np.where(_inertial(arm, base), values, np.maximum(np.nan_to_num(values), 0.0))
    return _with_links(arm, base, braking, optimum.links)


def physical_optimum(arm: Arm, base: BaseParameters, problem: TorqueProblem) -> tuple[Floats, Arm]:
    """Return the least-squares answer among the arms that can exist.

    Parameters
    ----------
    arm : Arm
        Of the many arms with one torque the nearest to it is taken; a link of its own that is not possible is
        replaced by a rod of 1 kg.
    base : BaseParameters
    problem : TorqueProblem

    Returns
    -------
    genes : (n_free,)
        Its cost is within a millionth of the noise's variance (and 1e-13 of the torque's power), times the number
        of rows of all pseudo-inertias and how much heavier than `arm` it is, of that of any possible arm.
    Arm
        With these values, every pseudo-inertia positive definite, every sought friction at least zero. What the
        data does not determine stays as it is in the problem, as nearly as what it does determine
        allows; the torque is the same.
    """
    n, n_base = arm.n_joint, len(base.independent)
    total = problem.sums.total()
    whitened = whiten(
        total.gram.sum(axis=(0, 1)), total.moment.sum(axis=(0, 1))[:, None], np.array([total.power.sum()])
    )
    W, z, rest = whitened.W, whitened.z[:, 0], float(whitened.rest[0])
    power = float(z @ z)
    mu = max(_NEAR_NOISE * rest / max(1.0, float(total.count.sum())), _NEAR_POWER * power)

    inertial, free = _inertial(arm, base), np.zeros(n_base, dtype=bool)
    free[problem.free] = True
    braking = np.flatnonzero(~inertial & free)
    kept = np.flatnonzero(~inertial & ~free)
    C = base.combination[:, : 10 * n]
    to_base = np.hstack([C * inertial[:, None], np.eye(n_base)[:, braking]])
    rest_of = np.flatnonzero(inertial & ~free)
    unit = np.maximum(np.abs(problem.prior), 1e-3 * max(1e-12, float(np.abs(problem.prior).max())))[rest_of]
    determined = _determined(W, problem.free, rest_of)
    weight = np.sqrt(np.where(determined, _HOLD * power, _PULL * mu)) / unit
    A = np.vstack([W @ to_base, weight[:, None] * to_base[rest_of]])
    b = np.concatenate([z - W[:, kept] @ problem.prior[kept], weight * problem.prior[rest_of]])

    strength = np.linalg.norm(W[:, braking], axis=0)
    optimum = least_squares_possible(A, b, nominal_links(arm), np.sqrt(power) / strength, mu)
    friction = np.where((strength * optimum.friction) ** 2 <= mu, 0.0, optimum.friction)  # at its bound
    values = problem.prior.copy()
    values[inertial] = C[inertial] @ optimum.links.ravel()
    values[braking] = friction
    others = np.flatnonzero(~free)
    shift = W[:, others] @ (values[others] - problem.prior[others])
    genes = values[problem.free] + np.linalg.lstsq(W[:, problem.free], shift, rcond=None)[0]
    return genes, _with_links(arm, base, values, optimum.links)


def _inertial(arm: Arm, base: BaseParameters) -> NDArray[np.bool_]:
    return np.asarray(base.independent) < 10 * arm.n_joint


def nominal_links(arm: Arm) -> Floats:
    """Return the arm's own links where they are possible, rods of 1 kg elsewhere, (n_joint, 10)."""
    links = standard_parameters(arm)[: 10 * arm.n_joint].reshape(-1, 10)
    return np.array([link if is_possible(link) else _ROD for link in links])


def _determined(W: Floats, free: NDArray[np.intp], others: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Say which of the other columns are independent of the free ones: those that were held on purpose."""
    new = W[:, others] - W[:, free] @ np.linalg.lstsq(W[:, free], W[:, others], rcond=None)[0]
    size = np.sum(W[:, others] ** 2, axis=0)
    return np.asarray(np.sum(new**2, axis=0) > _NEW_PART * size, dtype=np.bool_)


def _inverse_root(covariance: Floats, scale: Floats) -> Floats:
    """Return R with ``R^T R`` the inverse of a covariance; a parameter without one gets nearly no weight."""
    learnt = np.isfinite(np.diag(covariance))
    scaled = covariance[np.ix_(learnt, learnt)] / np.outer(scale[learnt], scale[learnt])
    variance, axes = np.linalg.eigh((scaled + scaled.T) / 2.0)
    root = np.zeros_like(covariance)
    root[np.ix_(learnt, learnt)] = (axes / np.sqrt(np.maximum(variance, _LEAST_VARIANCE))).T / scale[learnt]
    return root


def _violation(name: str, value: float, nearest: float, away: float | None, said: str) -> Violation:
    if away is None:
        sentence = f"{said}; the nearest possible value is {nearest:.4g}"
    elif away <= WITHIN_ERROR:
        sentence = f"{said}, but {nearest:.4g} is possible, and within its error ({away:.2g} standard errors away)"
    else:
        sentence = f"{said}; the nearest possible value, {nearest:.4g}, is {away:.3g} standard errors away"
    return Violation(name, value, nearest, away, sentence)


def _with_links(arm: Arm, base: BaseParameters, values: Floats, links: Floats) -> Arm:
    n, learnt = arm.n_joint, dict(zip(base.independent, values.tolist(), strict=True))
    joints = []
    for i, (joint, p) in enumerate(zip(arm.joints, links, strict=True)):
        friction = Friction(
            learnt.get(10 * n + i, joint.friction.viscous_N_m_s),
            learnt.get(11 * n + i, joint.friction.coulomb_N_m),
            joint.friction.static_N_m,
        )
        inertia, first, mass = p[:6].tolist(), p[6:9], float(p[9])
        link = Link(mass, tuple((first / mass).tolist()), tuple(inertia))
        joints.append(replace(joint, link=link, friction=friction))
    return replace(arm, joints=tuple(joints))
