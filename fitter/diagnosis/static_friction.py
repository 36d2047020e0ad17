r"""Static friction: a joint at rest is held by more than ever resists it while it moves.

The equations of a stuck joint have no information of the arm, and are eliminated from every fit (`weighting`).
They do show what holds the joint: the drive's torque less the arm's own. Coulomb friction holds up to its own
level; whatever holds more is the paper's F.

Two hypotheses hold a joint by more than Coulomb friction: static friction, and Stribeck friction.

At rest both are the same. Stribeck's hump of that height, ``A exp(-(v / v_s)^2)``, is still there while the
joint creeps; how wide it may be, or must be, is determined by the motion. Its height is determined by the rests:
at least what has held beyond Coulomb friction,

    A = max(A_held, (x / s_x^2 + A_0 / s_0^2) / (1 / s_x^2 + 1 / s_0^2)),

with the fit's own factor x of the hump, and the A_0 that the rests make likely.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, NEGLIGIBLE, SIGMAS, own_square
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.search import Cause, Search, StaticFriction
from fitter.diagnosis.whitening import inner_rests
from fitter.search.fitted_parameter import FittedParameter

#: What it is called.
EFFECT = "stiction"

#: Half width of the 95 % interval of F, relative to the largest torque that has held: F lies between that torque
#: and 1.4 times it.
_MORE = 0.2


def static_frictions(regression: Regression, final: Candidate, covariance: Floats) -> list[StaticFriction]:
    """Return the joints that stick, and at what torque.

    The largest torque that has held is a lower bound: how much more would have held is not known unless something
    is torn away slowly. F is reported as a fifth above it, and 95 % reach from it to almost half as much again.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        The model with all causes.
    covariance : (n_factor + n_psi, n_factor + n_psi)
        Of what was learnt: where the arm's own torque at rest is uncertain, a rest has little information.
    """
    known = np.nan_to_num(covariance)
    (level,) = catalogue()[EFFECT].parameters
    acting = (*regression.equations.given.hypotheses, *final.model.hypotheses)
    if any(one.kind.place == "transmission" for one in acting):
        return []  # what the links do at rest is not seen
    friction = regression.equations.friction(final.model, final.x, regression.motions[0])[:, 1]
    found = []
    for j in range(regression.arm.n_joint):
        if any(one.kind.holds and j in one.joints for one in final.model.hypotheses):
            continue
        # What the arm is known to stick with, its simulation has already.
        coulomb = max(abs(float(friction[j])), regression.arm.joints[j].friction.static_N_m)
        sets = [_held(regression, final, known, j, learn) for learn in (True, False)]
        torque, noise = (np.concatenate(column) for column in zip(*sets, strict=True))
        rms = float(np.sqrt(np.mean(np.concatenate([motion.u[:, j] for motion in regression.motions]) ** 2)))
        # Beyond the errors of noise and model, and what no model has in it.
        beyond = torque > (1.0 + _MORE) * coulomb + SIGMAS * noise + NEGLIGIBLE * rms
        if np.count_nonzero(beyond) <= 1:  # one may be a hand
            continue
        largest = float(torque.max())
        error = float(np.hypot((1.0 + _MORE) * _MORE / EQUAL_SIGMAS * largest, noise[int(np.argmax(torque))]))
        learnt = float(sets[0][0].max(initial=coulomb))
        was, remaining = (float(np.sum(np.maximum(sets[1][0] - level, 0.0) ** 2)) for level in (coulomb, learnt))
        gain = 1.0 - remaining / was if was > 0.0 else 0.0
        unit = level.unit_at(regression.arm.joints[j].type)
        found.append(StaticFriction(j, FittedParameter((1.0 + _MORE) * largest, error, unit, True), gain))
    return found


def sticking(arm: Arm, held: Sequence[StaticFriction]) -> Arm:
    """Return an arm whose joints stick, too."""
    effects = tuple(Effect(EFFECT, {"static_N_m": one.parameter.value}, joints=(one.joint + 1,)) for one in held)
    return replace(arm, effects=(*arm.effects, *effects)) if effects else arm


def _held(
    regression: Regression, final: Candidate, known: Floats, joint: int, learn: bool
) -> tuple[Floats, Floats]:
    """Return what has held a joint in each rest, and its standard error, (n_rest,) each."""
    torque, noise = [], []
    for motion in regression.motions:
        if motion.learn != learn:
            continue
        rests = inner_rests(motion.stuck[:, joint], motion.dt_s)
        if not rests:
            continue
        held = regression.equations.residual_torque(final.model, final.x, motion)[:, joint]
        slopes = regression.equations.slopes(final.model, final.x, motion)[:, joint]
        for part in rests:
            weight = np.hanning(part.stop - part.start + 2)[1:-1]
            weight /= weight.sum()
            torque.append(abs(float(weight @ held[part])))
            slope = weight @ slopes[part]
            model_error = np.sqrt(max(float(slope @ known @ slope), 0.0))
            noise.append(float(np.hypot(regression.weighting.mean_noise(joint, weight, motion.dt_s), model_error)))
    return np.array(torque), np.array(noise)


#: What it is called.
_EFFECT = "stribeck"


class HeldStribeck(JointHypothesis):
    """Stribeck's hump of a height determined by rests: psi is its width.

    Parameters
    ----------
    joint : int
        From 0.
    height : float [N m or N]
    height_error, width_error : float
        Standard error of the height, and what it makes of the width [rad/s].
    """

    def __init__(self, joint: int, height: float, height_error: float = 0.0, width_error: float = 0.0) -> None:
        super().__init__(catalogue()[_EFFECT], joint, {"amplitude_N_m": height})
        self.n_column = 0
        self._errors = np.array([height_error, width_error])

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose drive need not overcome the hump any more."""
        u = hypothetical.u.copy()
        u[:, self.joints[0]] -= self.torque(hypothetical, psi)[:, 0]
        return replace(hypothetical, u=u)

    def standard_errors(self, of_fit: Floats, motions: Sequence[Motion]) -> Floats:
        """Return them with the errors that the height brings."""
        return np.asarray(np.hypot(of_fit, self._errors))


@dataclass(frozen=True)
class Hump:
    """Friction that falls as a joint starts to move, as high as what holds it at rest.

    Attributes
    ----------
    hypothesis : HeldStribeck
    width : float [rad/s]
    lowers : float
        By how much it lowers the sum of squares; negative if it raises it, by too little to be excluded.
    needed : bool
        Whether it explains the motion, too, as static friction does not.
    """

    hypothesis: HeldStribeck
    width: float
    lowers: float
    needed: bool


def hump_of(regression: Regression, final: Candidate, holding: StaticFriction) -> Hump | None:
    """Return the hump that holds a joint; None if the motion excludes all that it could see.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        The model with all causes.
    holding : Holding
        What holds one of its joints.
    """
    joint, motions = holding.joint, regression.motions
    coulomb = abs(float(regression.equations.friction(final.model, final.x, motions[0])[joint, 1]))
    least, likely = holding.parameter.value / (1.0 + _MORE) - coulomb, holding.parameter.value - coulomb
    error = holding.parameter.std
    plain = float(regression.squares(final.model, regression.solve(final.model, motions)).sum())
    numbers = sum(regression.weighting.n_effective(motion) for motion in motions)
    free = JointHypothesis(catalogue()[_EFFECT], joint)

    def tried(width: float, given: float | None = None) -> tuple[float, float, bool]:
        """Return by how much a hump so wide raises the sum of squares, its height, and whether it shows."""
        model = final.model.plus(free, np.array([width]))
        x = regression.solve(model, motions)
        gram = sum(regression.rows(model, motion).columns.gram for motion in motions)
        information = own_square(np.asarray(gram))
        if not information * likely**2 > SIGMAS**2:
            return 0.0, likely, False
        height = (x[-1] * information + likely / error**2) / (information + 1.0 / error**2)
        height = max(least, float(height)) if given is None else given
        raised = float(regression.squares(model, x).sum()) - plain
        return raised + float((height - x[-1]) ** 2 * information), height, True

    def best(around: tuple[float, float], given: float | None = None) -> float:
        found = scipy.optimize.minimize_scalar(
            lambda log: tried(float(np.exp(log)), given)[0],
            bounds=(float(np.log(around[0])), float(np.log(around[1]))),
            method="bounded",
            options={"xatol": 1e-3},
        )
        return float(np.exp(found.x))

    starts = free.starts(motions)[:, 0]
    widths = np.geomspace(starts.min(), starts.max(), len(starts))
    raised = [one if seen else np.inf for one, _, seen in map(tried, widths)]
    k = int(np.argmin(raised))
    if raised[k] > NEGLIGIBLE * numbers:
        return None
    around = float(widths[max(k - 1, 0)]), float(widths[min(k + 1, len(widths) - 1)])
    width = best(around)
    raises, height, _ = tried(width)
    width_error = abs(best(around, height + error) - width)
    return Hump(HeldStribeck(joint, height, error, width_error), width, -raises, -raises > NEGLIGIBLE * numbers)


def with_humps(
    regression: Regression, search: Search, held: Sequence[StaticFriction]
) -> tuple[Search, list[StaticFriction], dict[int, Candidate]]:
    """Return a search with the humps that hold joints, what else holds joints, and the humps that might.

    Parameters
    ----------
    regression : Regression
    search : Search
    held : sequence of Holding
        The joints that are held by more than Coulomb friction.

    Returns
    -------
    Search, list of Holding, dict from joint to Candidate
    """
    others, equals = [], {}
    for one in held:
        hump = hump_of(regression, search.final, one)
        if hump is None:
            others.append(one)
            continue
        model = search.final.model.plus(hump.hypothesis, np.array([hump.width]))
        final = fitted(regression, model, refine=False)
        if hump.needed:
            cause = Cause(len(model.hypotheses) - 1, search.final, final)
            search = replace(search, final=final, causes=[*search.causes, cause])
        else:
            others.append(one)
            equals[one.joint] = final
    return search, others, equals
