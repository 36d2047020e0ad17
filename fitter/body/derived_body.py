"""Lengths, centres and axes of a whole person: limb by limb, and where the limbs hang on pelvis and thorax."""

from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.body.body_map import BodyLimbs
from fitter.limb.bundle import Bundle
from fitter.limb.free_geometry import Geometry
from fitter.limb.marker_observations import MarkerModel
from fitter.limb.uncertainty import Derived, derived, towards


def derived_body(where: BodyLimbs, geometry: Geometry, markers: MarkerModel, place: Floats) -> Derived:
    """Return what follows from a geometry and marker places.

    Parameters
    ----------
    where : BodyMap
    geometry : Geometry
    markers : MarkerModel
        As the fit of all frames has them: centres are given in its segments' frames.
    place : (m, 3) [m]
    """
    lengths, axes = dict[str, float](), dict[str, tuple[str, Floats]]()
    centres: dict[str, tuple[str, Floats]] = {}

    def hung(name: str, joint: int, segment: str) -> None:
        on_it = markers.link == where.links[segment]
        R, shift = towards(place[on_it], markers.place[on_it])
        centres[name] = (segment, R @ geometry.hang[joint, 1:] + shift)

    hung("lumbar", where.lumbar, "pelvis")
    for limb in where.limbs:
        own = limb_geometry(geometry, limb.first, limb.arm.n_joint)
        on_it = (markers.link >= limb.first) & (markers.link < limb.first + limb.arm.n_joint)
        found = derived(limb.where, own, markers.link[on_it] - limb.first, place[on_it], markers.place[on_it])
        lengths |= {f"{name}_{limb.where.side}": value for name, value in found.lengths.items()}
        first = next(iter(found.centres))
        hung(first, limb.first, limb.segment)
        centres |= {name: one for name, one in found.centres.items() if name != first}
        axes |= found.axes
    return Derived(lengths, centres, axes)


def limb_geometry(geometry: Geometry, first: int, n_joint: int) -> Geometry:
    """Return the numbers of one limb's joints as a chain of their own."""
    at = slice(first, first + n_joint)
    return replace(
        geometry,
        numbers=geometry.numbers[at].copy(),
        revolute=geometry.revolute[at],
        parent=geometry.parent[at] - first,
        hang=geometry.hang[at],
        base_R=np.eye(3),
        base_p=np.zeros(3),
    )


def markers_on(bundle: Bundle, link: int) -> dict[str, list[float]]:
    """Return the places of a link's markers in its joint-axis frame, by name [m]."""
    model = bundle.markers
    return {
        name: [float(x) for x in place]
        for name, on, place in zip(model.names, model.link, model.place, strict=True)
        if on == link
    }
