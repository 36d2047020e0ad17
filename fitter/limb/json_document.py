"""The JSON document of `fitter kinematics` for a person's limb."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from arm.model import Floats
from fitter.functional.disjoint import coverage_factor
from fitter.limb.base_motion import named
from fitter.limb.bundle import Bundle
from fitter.limb.free_geometry import FreeGeometry, Geometry
from fitter.limb.limb_fit import LimbFit
from fitter.limb.marker_errors import MarkerErrors
from fitter.limb.uncertainty import Derived, Errors, derived
from limbcal.command import Document

_COLUMNS = (("alpha", "rad", 0), ("a", "m", 1), ("d", "m", 2), ("beta", "rad", 3), ("theta_offset", "rad", 4))


def document(fit: LimbFit, scores: Mapping[str, MarkerErrors]) -> dict[str, object]:
    """Return the JSON document of a fit, without its notes and what it took.

    Parameters
    ----------
    fit : LimbFit
    scores : mapping of str to MarkerErrors
        Of ``learn`` and, where there are such trials, ``evaluate``.
    """
    base = [(f"base_{axis}", float(x), "m") for axis, x in zip("xyz", fit.bundle.geometry.base_p, strict=True)]
    own = derived(fit.where, fit.bundle.geometry, fit.bundle.markers.link, *[fit.bundle.markers.place] * 2)
    found = derived_document(own, fit.errors, lambda name: _length_std(fit, name), lambda s: _markers_of(fit, s))
    centres = dict(found["centres"])  # type: ignore[call-overload]
    for name in {functional.joint for functional in fit.functional} & centres.keys():
        centres[name] |= _score(fit, name)
    return {
        "parameters": parameters(fit.bundle.geometry, fit.free, fit.errors, base),
        **of_bundle(fit.bundle, len(fit.task.frames.t)),
        **_of_search(fit),
        **of_roles(scores, fit.marker_names, len(fit.bundle.markers.names), fit.arm.n_joint),
        **found,
    }


def _of_search(fit: LimbFit) -> Document:
    """Return how the genetic algorithm went, and how far it is from the bundle fit; nothing of a bundle fit."""
    if fit.rivals is None:
        return {}
    own = fit.rivals.found["ga"]
    return {
        "method": "ga",
        "population": own.population,
        "samples": own.frames,
        "compared": fit.rivals.document(),
    }


def of_bundle(bundle: Bundle, n_frame: int) -> Document:
    """Return how a fit went."""
    return {
        "method": "bundle",
        "generations": bundle.iterations,
        "samples": n_frame,
        "converged": bundle.converged,
    }


def of_roles(scores: Mapping[str, MarkerErrors], names: Sequence[str], n_limb: int, n_joint: int) -> Document:
    """Return how far markers are off and which share of their motion is explained.

    Parameters
    ----------
    scores : mapping of str to MarkerErrors
        Of ``learn`` and, where there are such trials, ``evaluate``; markers of a base come last.
    names : sequence of str
        Of the markers.
    n_limb : int
        How many of them are on links.
    n_joint : int
        Nobody measures a tip or a joint's angle; of each the fit without markers has a number.
    """
    rms: dict[str, object] = {role: of_markers(score.distance_m, n_limb) for role, score in scores.items()}
    last = list(scores.values())[-1].distance_m
    rms["per_marker"] = {name: rms_mm(last[:, m]) for m, name in enumerate(names)}
    explained = {role: score.explained for role, score in scores.items()}
    return {
        "marker_rms_mm": rms,
        "explained": {"learn": None, "evaluate": None} | explained,
        "tip_error_mm": {"learn": None, "evaluate": None},
        "angle_noise_deg": [None] * n_joint,
    }


def parameters(
    geometry: Geometry, free: FreeGeometry, errors: Errors, more: Sequence[tuple[str, float, str]]
) -> Document:
    """Return every number of eq. (1), and some more by name, value and unit; what is gauge has no error."""
    std = dict(zip(free.names, errors.free_std, strict=True))
    learnt = dict(zip(free.names, errors.learnt, strict=True))
    rows = [
        (f"{name}{i + 1}", row[column], unit)
        for i, row in enumerate(geometry.numbers)
        for name, unit, column in _COLUMNS
    ]
    return {
        name: {
            "value": float(value),
            "std": float(std[name]) if name in std else None,
            "unit": unit,
            "identifiable": bool(learnt.get(name, False)),
        }
        for name, value, unit in [*rows, *more]
    }


def derived_document(
    own: Derived,
    errors: Errors,
    length_std: Callable[[str], float],
    markers_of: Callable[[str], dict[str, list[float]]],
) -> dict[str, object]:
    """Return lengths, centres and axes with their errors.

    Parameters
    ----------
    own : Derived
    errors : Errors
    length_std : callable
        The least standard error of a length by name [m].
    markers_of : callable
        Markers of a segment in the frame of its centres.
    """
    variance, at = np.diag(errors.derived_covariance), 0
    lengths: dict[str, object] = {}
    factor = coverage_factor(errors.n_part)
    for name, value in own.lengths.items():
        std = max(float(np.sqrt(variance[at])), length_std(name))
        lengths[name] = {"value": value, "std": std, "ci95": [value - factor * std, value + factor * std]}
        at += 1
    centres: dict[str, object] = {}
    for name, (segment, place) in own.centres.items():
        std = float(np.sqrt(variance[at : at + 3].sum()))
        at += 3
        centres[name] = {
            "segment": segment,
            "position_m": [float(x) for x in place],
            "std_mm": 1e3 * std,
            "apart_mm": _finite(1e3 * errors.apart_m("centres", name)),
            "markers_m": markers_of(segment),
        }
    axes: dict[str, object] = {}
    for name, (segment, way) in own.axes.items():
        std = float(np.sqrt(variance[at : at + 3].sum()))
        at += 3
        posed = len(markers_of(segment)) >= 3
        axes[name] = {
            "segment": segment,
            "direction": [float(x) for x in way],
            "std_deg": float(np.degrees(std)) if posed else None,
            "apart_deg": _finite(float(np.degrees(errors.apart_m("axes", name)))) if posed else None,
        }
    return {"lengths_m": lengths, "centres": centres, "axes": axes}


def _length_std(fit: LimbFit, name: str) -> float:
    return float(fit.errors.free_std[fit.free.names.index(length_label(name, fit.where.balls[0]))])


def length_label(length: str, ball: int) -> str:
    """Return which number of eq. (1) a length is, given the first joint of hip or shoulder, from 0."""
    k = ball
    return {
        "upper_arm": f"d{k + 3}", "forearm": f"d{k + 5}", "girdle": f"a{k}",
        "thigh": f"d{k + 3}", "shank": f"a{k + 4}",
    }[length]  # fmt: skip


def _score(fit: LimbFit, joint: str) -> dict[str, object]:
    """Return how far SCoRE, by itself, has a centre from the fit; of the base's joint only."""
    found = next(f for f in fit.functional if f.joint == joint)
    if found.parent != fit.base.segment or joint != f"{next(iter(fit.where.centres))}_{fit.where.side}":
        return {}
    away = np.linalg.norm(found.in_parent_m - fit.bundle.geometry.base_p)
    return {"score_apart_mm": float(1e3 * away), "score_std_mm": _finite(1e3 * found.std_m)}


def _markers_of(fit: LimbFit, segment: str) -> dict[str, list[float]]:
    """Return the markers of a segment in the frame of its centres."""
    if segment == fit.where.base:
        return named(fit.base.markers, fit.base.points_m)
    model, link = fit.bundle.markers, fit.where.parts[segment].link
    on_it = [m for m, one in enumerate(model.link) if one == link]
    return named([model.names[m] for m in on_it], model.place[on_it])


def of_markers(distances_m: Floats, n_limb: int) -> Document:
    """Return rms, median and largest of markers' distances [mm]; ``limb``: rms without those of the base."""
    seen = distances_m[np.isfinite(distances_m)]
    return {
        "rms": rms_mm(distances_m),
        "median": float(1e3 * np.median(seen)),
        "max": float(1e3 * seen.max()),
        "limb": rms_mm(distances_m[:, :n_limb]),
        "frames": len(distances_m),
    }


def rms_mm(distances_m: Floats) -> float | None:
    """Return the rms of distances, NaN left out [mm]."""
    seen = distances_m[np.isfinite(distances_m)]
    return float(1e3 * np.sqrt(np.mean(seen**2))) if seen.size else None


def _finite(x: float) -> float | None:
    return x if np.isfinite(x) else None
