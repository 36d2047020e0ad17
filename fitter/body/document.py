"""The JSON document of `fitter kinematics` for a whole person."""

from collections.abc import Mapping

from arm.marker_kinematics import HANG_X
from fitter.body.body_fit import BodyFit
from fitter.body.derived_body import derived_body, markers_on
from fitter.limb.json_document import derived_document, length_label, of_bundle, of_roles, parameters
from fitter.limb.marker_errors import MarkerErrors


def body_document(fit: BodyFit, scores: Mapping[str, MarkerErrors]) -> dict[str, object]:
    """Return the JSON document of a fit, without its notes and what it took.

    Parameters
    ----------
    fit : BodyFit
    scores : mapping of str to MarkerErrors
        Of ``learn`` and, where there are such trials, ``evaluate``.
    """
    bundle, where, names = fit.bundle, fit.where, fit.marker_names
    free, balls = fit.task.free, {limb.name: limb.first + limb.where.balls[0] for limb in where.limbs}
    hung = [
        (name, float(bundle.geometry.hang[i, 1 + kind - HANG_X]), "m")
        for name, (kind, i) in zip(free.names, free.what.tolist(), strict=True)
        if kind >= HANG_X
    ]

    def length_std(name: str) -> float:
        length, _, side = name.rpartition("_")
        limb = "leg" if length in ("thigh", "shank") else "arm"
        label = length_label(length, balls[f"human-{limb}-{side}"])
        return float(fit.errors.free_std[free.names.index(label)])

    own = derived_body(where, bundle.geometry, bundle.markers, bundle.markers.place)
    return {
        "parameters": parameters(bundle.geometry, free, fit.errors, hung),
        **of_bundle(bundle, len(fit.task.frames.t)),
        **of_roles(scores, names, len(names), fit.arm.n_joint),
        **derived_document(own, fit.errors, length_std, lambda s: markers_on(bundle, where.links[s])),
    }
