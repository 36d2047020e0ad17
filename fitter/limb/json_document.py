"""The JSON document of `fitter kinematics` for a person's limb."""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.functional.disjoint import coverage_factor
from fitter.limb.base_motion import named
from fitter.limb.limb_fit import LimbFit
from fitter.limb.uncertainty import derived
from fitter.markers.recording import MarkerRecording
from limbcal.command import Document

_COLUMNS = (("alpha", "rad", 0), ("a", "m", 1), ("d", "m", 2), ("beta", "rad", 3), ("theta_offset", "rad", 4))


def document(
    fit: LimbFit, learn: Sequence[MarkerRecording], evaluate: Sequence[MarkerRecording], seed: int, seconds: float
) -> dict[str, object]:
    """Return the JSON document of a fit, without its notes."""
    learnt = fit.residuals_m(learn, seed)
    judged = fit.residuals_m(evaluate, seed) if evaluate else None
    n_limb = len(fit.bundle.markers.names)
    names = (*fit.bundle.markers.names, *fit.base.markers)
    judged_or_learnt = learnt if judged is None else judged
    marker_rms: dict[str, object] = {"learn": of_markers(learnt, n_limb)}
    if judged is not None:
        marker_rms["evaluate"] = of_markers(judged, n_limb)
    marker_rms["per_marker"] = {name: rms_mm(judged_or_learnt[:, m]) for m, name in enumerate(names)}
    return {
        "parameters": parameters(fit),
        "method": "bundle",
        "generations": fit.bundle.iterations,
        "samples": len(fit.task.frames.t),
        "seconds": seconds,
        "converged": fit.bundle.converged,
        "marker_rms_mm": marker_rms,
        **_derived_document(fit),
    }


def parameters(fit: LimbFit) -> Document:
    """Return every number of eq. (1) and frame 0's place, with its error; what is gauge has none."""
    std = dict(zip(fit.free.names, fit.errors.free_std, strict=True))
    learnt = dict(zip(fit.free.names, fit.errors.learnt, strict=True))
    found: dict[str, object] = {}

    def add(name: str, value: float, unit: str) -> None:
        found[name] = {
            "value": float(value),
            "std": float(std[name]) if name in std else None,
            "unit": unit,
            "identifiable": bool(learnt.get(name, False)),
        }

    for i, row in enumerate(fit.bundle.geometry.numbers):
        for name, unit, column in _COLUMNS:
            add(f"{name}{i + 1}", row[column], unit)
    for axis, value in zip("xyz", fit.bundle.geometry.base_p, strict=True):
        add(f"base_{axis}", value, "m")
    return found


def _derived_document(fit: LimbFit) -> dict[str, object]:
    """Return lengths, centres and axes with their errors."""
    markers, errors = fit.bundle.markers, fit.errors
    own = derived(fit.where, fit.bundle.geometry, markers.link, markers.place, markers.place)
    variance, at = np.diag(errors.derived_covariance), 0
    lengths: dict[str, object] = {}
    factor = coverage_factor(errors.n_part)
    floor = dict(zip(fit.free.names, errors.free_std, strict=True))
    for name, value in own.lengths.items():
        std = float(np.sqrt(variance[at]))
        std = max(std, _length_std(floor, fit, name))
        lengths[name] = {"value": value, "std": std, "ci95": [value - factor * std, value + factor * std]}
        at += 1
    centres: dict[str, object] = {}
    score = {f.joint: f for f in fit.functional}
    for name, (segment, place) in own.centres.items():
        std = float(np.sqrt(variance[at : at + 3].sum()))
        at += 3
        centres[name] = {
            "segment": segment,
            "position_m": [float(x) for x in place],
            "std_mm": 1e3 * std,
            "apart_mm": _finite(1e3 * errors.apart_m("centres", name)),
            "markers_m": _markers_of(fit, segment),
        }
        if name in score:
            centres[name] |= _score(fit, name)  # type: ignore[operator]
    axes: dict[str, object] = {}
    for name, (segment, way) in own.axes.items():
        std = float(np.sqrt(variance[at : at + 3].sum()))
        at += 3
        axes[name] = {
            "segment": segment,
            "direction": [float(x) for x in way],
            "std_deg": float(np.degrees(std)) if len(_markers_of(fit, segment)) >= 3 else None,
            "apart_deg": _finite(float(np.degrees(errors.apart_m("axes", name))))
            if len(_markers_of(fit, segment)) >= 3
            else None,
        }
    return {"lengths_m": lengths, "centres": centres, "axes": axes}


def _length_std(free_std: dict[str, float], fit: LimbFit, name: str) -> float:
    k = fit.where.balls[0]
    label = {"upper_arm": f"d{k + 3}", "thigh": "d3", "forearm": f"d{k + 5}", "shank": "a4", "girdle": "a2"}[name]
    return float(free_std[label])


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
