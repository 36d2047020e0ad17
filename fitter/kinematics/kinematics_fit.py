"""What was learnt of an arm's geometry, and its JSON document."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.kinematics.angle_noise import Source
from fitter.kinematics.gauge import Gauge
from fitter.kinematics.origin import About
from fitter.kinematics.tip_basis import turning
from fitter.kinematics.tip_error import TipScore
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note, documents


@dataclass(frozen=True)
class KinematicsFit:
    """What was learnt of an arm's geometry.

    Attributes
    ----------
    arm : Arm
        The arm with the learnt geometry.
    parameters : mapping from name to FittedParameter
        alpha1, a1, d1, beta1, theta_offset1, alpha2, …
    generations, population, samples : int
    seconds : float
    tip_rms_m : float
        What the fit leaves of the tip's displacement, without the share of the angles' noise that was undone.
    about : {"rest", "mean"}
        What displacements were counted from.
    angle_noise_rad : (n_joint,) or None
        Standard deviation of the angles' noise (m where a joint slides); None where it could not be estimated.
    angle_noise_source : {"known", "spectrum", "moments"} or None
    gauge : tuple of Gauge
        What the data leaves open.
    drawn : (n_draw, n_joint, 5) or None
        The geometry as it may be, where the motions' trackers say how well they know them.
    notes : tuple of Note
        What the user should know of this answer.
    """

    arm: Arm
    parameters: Mapping[str, FittedParameter]
    generations: int
    population: int
    samples: int
    seconds: float
    tip_rms_m: float
    about: About = "rest"
    angle_noise_rad: Floats | None = None
    angle_noise_source: Source | None = None
    gauge: tuple[Gauge, ...] = ()
    drawn: Floats | None = None
    notes: tuple[Note, ...] = ()


def document(fit: KinematicsFit, learn: TipScore, evaluate: TipScore | None = None) -> dict[str, object]:
    """Return the JSON document of ``fitter kinematics``."""
    scores = {"learn": learn, "evaluate": evaluate}
    return {
        "parameters": {name: parameter.document() for name, parameter in fit.parameters.items()},
        "method": "ga",
        "generations": fit.generations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "tip_error_mm": {role: s and {"mean": s.mean_mm, "max": s.max_mm} for role, s in scores.items()},
        "angle_noise_deg": angle_noise_deg(fit),
        "angle_noise_source": fit.angle_noise_source,
        "about": fit.about,
        "gauge": [freedom.document() for freedom in fit.gauge],
        "explained": {role: s and s.explained for role, s in scores.items()},
        "ci95": {name: parameter.ci95 for name, parameter in fit.parameters.items()},
        "notes": documents(fit.notes),
    }


def gauge_sentences(fit: KinematicsFit) -> list[str]:
    """Return a sentence for each freedom that the data leaves, in which `identifiable` says what is known."""
    identifiable = {name for name, parameter in fit.parameters.items() if parameter.identifiable}
    return [freedom.sentence(identifiable) for freedom in fit.gauge]


def angle_noise_deg(fit: KinematicsFit) -> list[float | None]:
    """Return the angles' noise in degrees, in millimetres where a joint slides, null where it is not estimated."""
    if fit.angle_noise_rad is None:
        return [None] * fit.arm.n_joint
    turns = turning(fit.arm)
    return [
        float(np.rad2deg(noise) if turning_too else 1e3 * noise)
        for noise, turning_too in zip(fit.angle_noise_rad, turns, strict=True)
    ]
