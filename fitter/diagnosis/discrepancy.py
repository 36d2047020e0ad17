"""Model discrepancy: the variables it depends on, how much of it is predictable, and a formula as a hint.

Functions of a few variables are fitted with the base parameters, by cross-validation over trials.
The fewest variables whose function explains nearly as much as any are what the remainder depends on. The base
parameters are fitted along, for the residual of a previous fit lacks what its parameters absorbed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy

from fitter.diagnosis.basis_functions import Discrepancy, names
from fitter.diagnosis.cross_validation import CrossValidation, dependences, typical
from fitter.diagnosis.evidence import NOISE_VARIANCE_TOLERANCE, Floor
from fitter.diagnosis.least_squares import CLEAR_RATIO, EQUAL_SIGMAS, ODDS_NATS, UNEXPLAINED
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.trial_offsets import offset_sizes
from fitter.parallel.forked import side_by_side


@dataclass(frozen=True)
class BestFunctions:
    """The residual of functions of few variables in addition to a model.

    Attributes
    ----------
    joint : int
        At whose torque the best one is, from 0.
    of_size : dict of int to tuple of str
        The variables of the best one there, by how many they are.
    typical_chi2 : dict of int to float
        Geometric mean of the held-out trials' chi2 with it, in units of noise.
    """

    joint: int
    of_size: dict[int, tuple[str, ...]]
    typical_chi2: dict[int, float]

    @property
    def least(self) -> float:
        """What the best of all leaves."""
        return min(self.typical_chi2.values())


def best_functions(fold: CrossValidation, n_joint: int) -> BestFunctions:
    """Seek the best function of one, two and three variables at any one joint; three contain the best two."""
    variables = names(n_joint)
    sets = [some for size in (1, 2) for some in combinations(variables, size) if _sensible(some)]
    places = [(some, joint) for joint in range(n_joint) for some in sets]
    alone = dict(zip(places, side_by_side(lambda place: fold.typical(*place), places), strict=True))
    some, joint = min(alone, key=lambda key: alone[key])
    of_size = {len(some): some}
    chi2 = {len(some): fold.typical(some, joint, smooth=True)}
    if len(some) == 2:
        singles = [key for key in alone if len(key[0]) == 1 and key[1] == joint]
        of_size[1] = min(singles, key=lambda key: alone[key])[0]
        chi2[1] = fold.typical(of_size[1], joint, smooth=True)
        triples = [triple for third in variables if third not in some and _sensible(triple := (*some, third))]
        by_triple = side_by_side(lambda triple: fold.typical(triple, joint, smooth=True), triples)
        k = int(np.argmin(by_triple))
        of_size[3], chi2[3] = triples[k], by_triple[k]
    return BestFunctions(joint, of_size, chi2)


def surpassed(regression: Regression, final: Candidate) -> bool:
    """Say whether a function of few variables leaves trials with clearly less than all causes do in its place.

    Both are judged on the same trials that base parameters were not fitted to, by the sensors' noise: a floor was
    made for the causes. Both are fitted under those weights. The causes' own numbers, which are few, are those of
    all trials: from learning trials alone they may be known badly, and would predict badly. No formula is exact,
    so the causes have to leave twice as much beyond noise, whose size is known to a tenth; the difference of the
    logarithms has to be two of its standard errors over the trials.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        The model with all causes.
    """
    own = regression.weighted_by(regression.sensors)
    by_causes = CrossValidation(own, fitted(own, final.model, refine=False, to_all=True)).held_out
    beyond, known = float(np.mean(by_causes / own.n_effective)) - 1.0, NOISE_VARIANCE_TOLERANCE - 1.0
    if beyond <= CLEAR_RATIO * known:  # whatever a function left, it would not be clearly less
        return False
    fold = CrossValidation(own, fitted(own, Model()))
    functions = best_functions(fold, own.arm.n_joint)
    size = min(functions.typical_chi2, key=lambda k: functions.typical_chi2[k])
    # Less than the noise alone would leave is chance, or rounding.
    chi2 = np.maximum(fold.squares(functions.of_size[size], functions.joint, smooth=True), own.n_effective)
    logs = np.log(np.maximum(by_causes, own.n_effective) / chi2)
    error = logs.std(ddof=1) / np.sqrt(len(logs)) if len(logs) > 1 else np.inf
    least_beyond = float(np.mean(chi2 / own.n_effective)) - 1.0
    return bool(logs.mean() > EQUAL_SIGMAS * error and beyond > CLEAR_RATIO * max(least_beyond, known))


def describe(regression: Regression, final: Candidate, floor: Floor) -> Discrepancy:
    """Describe a model's discrepancy.

    Parameters
    ----------
    regression : Regression
        Under the weights with the floor.
    final : Candidate
    floor : Floor
        Of the model; where there is none, the residual is noise, and no function of anything.
    """
    white, alone = _white(regression, final), dependences(regression, final)
    if floor.is_none:
        return Discrepancy(0.0, 0.0, white, (), 0, "", alone, (0.0,) * regression.arm.n_joint)
    weighting, learning = regression.weighting, regression.learning
    offsets = offset_sizes(regression.equations, weighting, final.model, final.x, learning)
    fold = CrossValidation(regression, final)
    functions = best_functions(fold, regression.arm.n_joint)
    best, joint = functions.least, functions.joint
    # A further variable explains more than what may stay unexplained, and beyond what noise is known to.
    enough = min(best + UNEXPLAINED * max(fold.typical_chi2 - best, 0.0), NOISE_VARIANCE_TOLERANCE * best)
    some = functions.of_size[min(size for size, chi2 in functions.typical_chi2.items() if chi2 <= enough)]
    # A function must do better than the model as it is, not only than one fitted to fewer trials.
    n_effective = regression.n_effective
    most = min(fold.typical_chi2, typical(final.squares, n_effective))
    gain = max(most - best, 0.0)
    is_significant = gain > UNEXPLAINED
    return Discrepancy(
        explained=float(np.clip(gain / most, 0.0, 1.0)),
        gain=gain,
        white=white,
        depends_on=some if is_significant else (),
        joint=joint + 1 if is_significant else 0,
        formula=fold.formula(some, joint, fold.typical_chi2 - best) if is_significant else "",
        dependences=alone,
        trial_offsets_N_m=tuple(offsets.tolist()),
    )


def _sensible(some: Sequence[str]) -> bool:
    """Say whether a set does not hold a velocity and its own sign: the function of the velocity knows it."""
    return not any(f"sign({name})" in some for name in some)


def _white(regression: Regression, final: Candidate) -> bool:
    """Say whether neighbouring residuals have nothing to do with one another, by the spectrum of each trial.

    Of white noise every frequency has the same share; the largest departure of its running sum from a straight
    line follows Kolmogorov's law (Bartlett 1954).
    """
    # Kolmogorov's law leaves the probability of a false cause above this.
    most, worst = float(scipy.stats.kstwobign.isf(np.exp(-ODDS_NATS))), 0.0
    flat = regression.weighting.flat_share(regression.motions[0].dt_s)
    for joint in range(regression.arm.n_joint):
        power = np.zeros(128)
        for motion in regression.motions:
            residual = regression.residual(final.model, final.x, motion)[:, joint]
            spectrum = np.abs(np.fft.rfft(residual, 256))[1:] ** 2
            power = power + spectrum
        f = np.arange(1, 129) / 128.0
        # The band ends before the slower grid's own limit, and its edge is soft: only its flat part is looked at.
        inside = f < flat
        running = np.cumsum(power[inside]) / np.sum(power[inside])
        expected = np.arange(1, len(running) + 1) / len(running)
        n = sum(len(motion.t) for motion in regression.motions) / regression.weighting.stride * flat / 2.0
        worst = max(worst, float(np.max(np.abs(running - expected))) - most / np.sqrt(n))
    return worst < UNEXPLAINED  # the spectrum of the noise is known to some percent only
