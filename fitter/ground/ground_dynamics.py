"""What a person's masses, centres and inertias are by measured ground forces, and what of it was learnt at all."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from arm.model import Arm, Estimate, Floats, Link
from arm.regressor import standard_names
from fitter.ground.deformation import Deformation
from fitter.ground.disturbances import plate_columns, plate_stds, skin_columns, skin_of
from fitter.ground.floating_base import FloatingBase
from fitter.ground.frequency_rows import FrequencyRows, frequency_rows
from fitter.ground.ground_fit import Posterior, ground_fit
from fitter.ground.ground_trial import GroundTrial
from fitter.ground.mass_prior import table_prior, vague_prior
from fitter.ground.plate_calibration import PlateCalibration, plate_calibration
from fitter.search.fitted_parameter import FittedParameter

#: A parameter is learnt if its posterior standard deviation is at most half of the prior's, and left at the prior
#: if more than nine tenths of its variance remain: conventions.
LEARNT, LEFT_AT_PRIOR = 0.75, 0.1
_UNITS = ("kg m^2",) * 6 + ("kg m",) * 3 + ("kg",)


@dataclass(frozen=True)
class Combination:
    """A sum of standard parameters, without unit, that is identified although its terms may not be.

    Attributes
    ----------
    terms : dict of str to float
        Name and coefficient; the prior's standard deviation of the sum is one.
    value, std : float
    learnt : float
        0..1.
    """

    terms: dict[str, float]
    value: float
    std: float
    learnt: float


@dataclass(frozen=True)
class GroundFit:
    """What was learnt.

    Attributes
    ----------
    arm : Arm
        With the most likely bodies in its links.
    base : FloatingBase
    names : tuple of str
        Of the standard parameters.
    values, before : (10 n_body,)
        Most likely, and the arm's own.
    covariance, prior_covariance : (10 n_body, 10 n_body)
        Of the standard parameters, both about the most likely bodies.
    posterior : Posterior
    plates : PlateCalibration
    combinations : tuple of Combination
        Learnt ones, the best known first.
    band_hz : float
    samples : int
    seconds : float
    condition_number : float
    """

    arm: Arm
    base: FloatingBase
    names: tuple[str, ...]
    values: Floats
    before: Floats
    covariance: Floats
    prior_covariance: Floats
    posterior: Posterior
    plates: PlateCalibration
    combinations: tuple[Combination, ...]
    band_hz: float
    samples: int
    seconds: float
    condition_number: float

    @property
    def learnt(self) -> Floats:
        """1 − (posterior std / prior std)², of each standard parameter."""
        return np.asarray(np.clip(1.0 - np.diag(self.covariance) / np.diag(self.prior_covariance), 0.0, 1.0))

    @property
    def parameters(self) -> dict[str, FittedParameter]:
        """Standard parameters of the bodies, by name."""
        std = np.sqrt(np.diag(self.covariance))
        return {
            name: FittedParameter(
                float(self.values[k]), float(std[k]), _UNITS[k % 10], bool(self.learnt[k] >= LEARNT)
            )
            for k, name in enumerate(self.names)
        }

    @property
    def total_kg(self) -> tuple[float, float]:
        """Mass of the whole person and its standard error [kg]."""
        row = np.zeros(len(self.names))
        row[9::10] = 1.0
        return float(row @ self.values), float(np.sqrt(row @ self.covariance @ row))


def learn_from_ground(
    arm: Arm, base: FloatingBase, trials: Sequence[GroundTrial], *, regression: bool, band_hz: float
) -> GroundFit:
    """Learn the bodies of a person.

    Parameters
    ----------
    arm : Arm
        Its links are where the prior is centred.
    base : FloatingBase
    trials : sequence of GroundTrial
    regression : bool
        Whether the links are a table's, with the spread of `fitter.ground.mass_prior`; else nothing is known of
        them.
    band_hz : float
        Corner of the fit.

    Raises
    ------
    NotConverged
        If the search does not end.
    """
    began = time.perf_counter()
    total = None if arm.body is None else arm.body.mass_kg
    prior = table_prior(base.links[:, 9], total) if regression else vague_prior(len(base.bodies))
    deformation = Deformation(base.links)
    rows, std = learning_rows(arm, base, trials, band_hz)
    posterior = ground_fit(rows, deformation, prior, std)
    slopes = deformation.slopes(posterior.x)
    covariance, before = (slopes @ C @ slopes.T for C in (posterior.covariance, prior.covariance))
    names = tuple(standard_names(arm.n_joint)[10 * i + k] for i in base.bodies for k in range(10))
    values = deformation.parameters(posterior.x)
    known = _combinations(names, values, covariance, before)
    size = np.linalg.norm(rows.Y[..., : len(names)], axis=(0, 1))
    scaled = (rows.Y[..., : len(names)] / np.where(size > 0.0, size, 1.0)).reshape(-1, len(names))
    fit = GroundFit(
        arm,
        base,
        names,
        values,
        base.links.ravel(),
        covariance,
        before,
        posterior,
        plate_calibration(rows, std, posterior, values, covariance),
        known,
        band_hz,
        sum(len(trial.t) for trial in trials),
        time.perf_counter() - began,
        float(np.linalg.cond(scaled)),
    )
    return replace(fit, arm=_with_bodies(arm, fit))


def learning_rows(
    arm: Arm, base: FloatingBase, trials: Sequence[GroundTrial], band_hz: float
) -> tuple[FrequencyRows, Floats]:
    """Return the equations of trials with the disturbances' columns, and their standard deviations."""
    skin = skin_of(arm, base, [trial.postures for trial in trials])
    columns = [
        np.concatenate(
            [trial.Y, skin_columns(base, trial.motions, trial.postures, skin), plate_columns(trial.wrench)], axis=2
        )
        for trial in trials
    ]
    rows = frequency_rows(columns, [trial.wrench for trial in trials], [trial.dt_s for trial in trials], band_hz)
    return rows, np.concatenate([skin.stds(), plate_stds()])


def _combinations(
    names: Sequence[str], values: Floats, covariance: Floats, prior: Floats
) -> tuple[Combination, ...]:
    """Return the directions in which the posterior is narrow, in units of the prior."""
    unit = np.sqrt(np.diag(prior))
    variance, directions = scipy.linalg.eigh(covariance / np.outer(unit, unit), prior / np.outer(unit, unit))
    found = []
    for k in np.flatnonzero(1.0 - variance >= LEARNT).tolist():
        row = directions[:, k] / unit
        if row @ values < 0.0:
            row = -row
        terms = {name: float(c) for name, c in zip(names, row, strict=True)}
        found.append(
            Combination(terms, float(row @ values), float(np.sqrt(variance[k])), float(1.0 - variance[k]))
        )
    return tuple(found)


def _with_bodies(arm: Arm, fit: GroundFit) -> Arm:
    joints = list(arm.joints)
    for k, i in enumerate(fit.base.bodies):
        inertia, first, mass = np.split(fit.values[10 * k : 10 * k + 10], [6, 9])
        centre = first / mass[0]
        link = Link(
            float(mass[0]),
            (float(centre[0]), float(centre[1]), float(centre[2])),
            tuple(inertia.tolist()),
            arm.joints[i].link.air_drag_N_m_s2,
        )
        joints[i] = replace(joints[i], link=link)
    learnt = {name: Estimate(p.value, p.std) for name, p in fit.parameters.items() if p.identifiable}
    return replace(arm, joints=tuple(joints), base_parameters=learnt)
