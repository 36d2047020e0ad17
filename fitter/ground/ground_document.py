"""The JSON document of `fitter dynamics --ground`."""

from collections.abc import Mapping, Sequence

import numpy as np

from arm.model import Floats
from fitter.ground.ground_dynamics import LEFT_AT_PRIOR, GroundFit
from fitter.ground.ground_score import GroundScore
from fitter.ground.ground_trial import GroundTrial

#: A term of a combination is named where its share of the prior's standard deviation is at least this.
_NAMED_SHARE = 0.3


def document(
    fit: GroundFit,
    scores: Mapping[str, GroundScore | None],
    trials: Sequence[GroundTrial],
    names: Sequence[str],
    *,
    prior: bool,
) -> dict[str, object]:
    """Return the document, without its notes.

    Parameters
    ----------
    fit : GroundFit
    scores : mapping of str to GroundScore or None
        By role, ``learn`` and ``evaluate``.
    trials : sequence of GroundTrial
    names : sequence of str
        Of the arm's links.
    prior : bool
        Whether a table's prior was given.
    """
    parameters = {name: parameter.document() for name, parameter in fit.parameters.items()}
    if prior:
        for name, share in zip(fit.names, fit.learnt.tolist(), strict=True):
            parameters[name]["learnt"] = share
    total, std = fit.total_kg
    answer: dict[str, object] = {
        "parameters": parameters,
        "method": "least-squares",
        "objective": "ground",
        "generations": fit.posterior.rounds,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "condition_number": fit.condition_number,
        "torque_rms_N_m": {role: s and _of_joints(fit, s.joint_rms) for role, s in scores.items()},
        "angle_error_deg": dict.fromkeys(scores),  # a person is simulated by no law
        "explained": {role: s and _of_joints(fit, s.explained) for role, s in scores.items()},
        "ci95": {name: parameter.ci95 for name, parameter in fit.parameters.items()},
        "ground_residual": {role: s and s.document() for role, s in scores.items()},
        "plates": fit.plates.document(),
        "band_hz": fit.band_hz,
        "total_mass_kg": {"value": total, "std": std},
        "segments": segment_rows(fit, names),
        "combinations": [
            {"terms": c.terms, "value": c.value, "std": c.std, "learnt": c.learnt} for c in fit.combinations
        ],
        "contacts": [
            {"trial": trial.name, "plate": plate, "joint": link + 1}
            for trial in trials
            for plate, link in trial.contacts
        ],
        "clock_shift_s": {trial.name: trial.shift.shift_s for trial in trials},
    }
    if prior:
        answer["left_at_prior"] = left_at_prior(fit)
        answer["known_together"] = known_together(fit)
    return answer


def left_at_prior(fit: GroundFit) -> list[str]:
    """Return the parameters of which the ground tells next to nothing."""
    return [name for name, share in zip(fit.names, fit.learnt.tolist(), strict=True) if share < LEFT_AT_PRIOR]


def known_together(fit: GroundFit) -> list[list[str]]:
    """Return the terms that matter of every learnt combination whose terms are not known by themselves."""
    found = []
    unit = dict(zip(fit.names, np.sqrt(np.diag(fit.prior_covariance)).tolist(), strict=True))
    alone = {name for name, parameter in fit.parameters.items() if parameter.identifiable}
    for one in fit.combinations:
        size = {name: abs(c) * unit[name] for name, c in one.terms.items()}
        largest = max(size.values())
        together = [name for name, s in size.items() if s >= _NAMED_SHARE * largest]
        if len(together) > 1 and not alone.issuperset(together):
            found.append(together)
    return found


def segment_rows(fit: GroundFit, names: Sequence[str]) -> list[dict[str, object]]:
    """Return mass, centre and inertia about the centre of every body, with standard errors and learnt shares."""
    rows = []
    for k, link in enumerate(fit.base.bodies):
        own = slice(10 * k, 10 * k + 10)
        theta, C, C0 = fit.values[own], fit.covariance[own, own], fit.prior_covariance[own, own]
        J = np.vstack([_mass_row(), _centre_slopes(theta), _inertia_slopes(theta)])
        std, prior = (np.sqrt(np.diag(J @ S @ J.T)) for S in (C, C0))
        centre = theta[6:9] / theta[9]
        before = fit.before[own]
        rows.append(
            {
                "segment": names[link],
                "joint": link + 1,
                "mass_kg": {"value": float(theta[9]), "std": float(std[0]), "prior": float(before[9])},
                "com_m": {
                    "value": centre.tolist(),
                    "std": std[1:4].tolist(),
                    "prior": (before[6:9] / before[9]).tolist(),
                },
                "inertia_kg_m2": {"value": _about_centre(theta).tolist(), "std": std[4:].tolist()},
                "learnt": {
                    "mass": float(np.clip(1.0 - (std[0] / prior[0]) ** 2, 0.0, 1.0)),
                    "com": np.clip(1.0 - (std[1:4] / prior[1:4]) ** 2, 0.0, 1.0).tolist(),
                    "inertia": np.clip(1.0 - (std[4:] / prior[4:]) ** 2, 0.0, 1.0).tolist(),
                },
            }
        )
    return rows


def _of_joints(fit: GroundFit, base: Floats) -> list[float]:
    """Return one number a joint: NaN for those that something drives."""
    rows = np.full(fit.arm.n_joint, np.nan)
    rows[list(fit.base.joints)] = base
    return rows.tolist()


def _mass_row() -> Floats:
    return np.eye(10)[9:]


def _centre_slopes(theta: Floats) -> Floats:
    J = np.zeros((3, 10))
    J[:, 6:9] = np.eye(3) / theta[9]
    J[:, 9] = -theta[6:9] / theta[9] ** 2
    return J


def _about_centre(theta: Floats) -> Floats:
    """Return ``xx yy zz xy xz yz`` about the centre of mass (Steiner)."""
    m, (x, y, z) = theta[9], theta[6:9]
    own = np.array([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])
    return np.asarray(theta[:6] - own / m)


def _inertia_slopes(theta: Floats) -> Floats:
    m, (x, y, z) = theta[9], theta[6:9]
    J = np.zeros((6, 10))
    J[:, :6] = np.eye(6)
    J[:, 6] = -np.array([0.0, 2 * x, 2 * x, -y, -z, 0.0]) / m
    J[:, 7] = -np.array([2 * y, 0.0, 2 * y, -x, 0.0, -z]) / m
    J[:, 8] = -np.array([2 * z, 2 * z, 0.0, 0.0, -x, -y]) / m
    J[:, 9] = np.array([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z]) / m**2
    return J
