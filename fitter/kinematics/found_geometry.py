"""What a search has found of a geometry, and how well it is known: by draws, by motions, or by their samples."""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.data.trial import Trial
from fitter.kinematics.drawn_tip import drawn_geometry
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.kinematics_fit import KinematicsFit
from fitter.kinematics.tip_basis import UNITS, geometry_names, with_geometry
from fitter.search.clusters import motion_notes
from fitter.search.drawn import covariance_of
from fitter.search.fitted_parameter import FittedParameter, fitted_parameters, held_back
from limbcal.errors import NotIdentifiable


def fit_of(search: IncrementalKinematics, trials: Sequence[Trial]) -> KinematicsFit:
    """Return what a search has found so far, with standard errors.

    They are from the draws of the trials' motions, where all have them; else from samples and motions, see
    `fitter.search.clusters.covariance_of_motions`. The answer of a single tracked motion without draws is held
    back: its error is unknown.

    Parameters
    ----------
    search : IncrementalKinematics
    trials : sequence of Trial
        That it was found from, with tips.

    Raises
    ------
    NotIdentifiable
        If nothing is identifiable yet.
    """
    require_determined(search)
    arm = with_geometry(search.arm, search.best)
    drawn = drawn_geometry(search.arm, arm, search.sought, trials)
    if drawn is None:
        covariance, freedom = search.known(tracked=any(trial.tracked for trial in trials))
    else:
        freedom = float(len(drawn.departures))
        departures = drawn.departures.reshape(len(drawn.departures), -1)[:, search.sought]
        covariance = covariance_of(departures, drawn.residual_square, drawn.found, search.scattered())
    std = np.full(search.best.size, np.nan)
    std[search.sought] = np.sqrt(np.diag(covariance))
    parameters = parameters_of(search, search.best, std, freedom)
    return KinematicsFit(
        arm=arm,
        parameters=held_back(parameters) if np.isnan(freedom) else parameters,
        generations=search.generations,
        population=search.population,
        samples=search.samples,
        seconds=0.0,
        tip_rms_m=search.tip_rms_m,
        gauge=search.gauge(),
        drawn=None if drawn is None else search.best + drawn.departures,
        notes=motion_notes(freedom),
    )


def parameters_of(
    search: IncrementalKinematics, geometry: Floats, std: Floats, freedom: float = np.inf
) -> dict[str, FittedParameter]:
    """Return the parameters of a geometry by name.

    Parameters
    ----------
    search : IncrementalKinematics
        Which says what is determined.
    geometry : (n_joint, 5)
    std : (5 n_joint,)
        Standard errors, NaN where a parameter is not determined.
    freedom : float
        Degrees of freedom that they were estimated with.
    """
    n, is_determined = search.arm.n_joint, search.is_determined.ravel()
    return fitted_parameters(geometry_names(n), geometry.ravel(), std, UNITS * n, is_determined, freedom)


def require_determined(search: IncrementalKinematics) -> None:
    """Raise a NotIdentifiable where nothing is identifiable yet."""
    if not np.any(search.is_determined):
        raise NotIdentifiable(
            f"no geometric parameter can be identified from {search.samples} samples: "
            "the tip or the joints don't move"
        )
