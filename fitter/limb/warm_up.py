"""Going through the fit and the tracking of a limb on hardly any data, so that their kernels are compiled."""

from dataclasses import replace

import numpy as np

from arm.body.landmarks import limb_map
from arm.body.limbs import MEAN_PERSON, limb
from arm.model import Base, Marker
from fitter.functional.marker_set import MarkerSet
from fitter.limb.limb_calibration import calibrate
from fitter.limb.limb_search import Search
from fitter.limb.tracking import track_limb
from protocol.markers.recording import MarkerRecording

_FRAMES, _RATE_HZ = 24, 50.0


def warm_up() -> None:
    """Fit and track a limb of no interest."""
    arm = limb(replace(MEAN_PERSON, preset="human-leg-right"))
    where = limb_map(arm.name, arm.n_joint)
    rng = np.random.default_rng(0)
    names, links = list[str](), list[int]()
    segments = dict[str, tuple[str, ...]]()
    for segment, link in [(where.base, 0), *((s, part.link + 1) for s, part in where.parts.items())]:
        segments[segment] = tuple(f"{segment}{k}" for k in range(3))
        names += segments[segment]
        links += [link] * 3
    places = rng.normal(scale=0.1, size=(len(names), 3))
    wobble = 0.02 * rng.normal(size=(_FRAMES, len(names), 3))
    height = -0.4 * np.array(links)[:, None] * np.array([0.0, 0.0, 1.0])
    recording = MarkerRecording("warm-up", _RATE_HZ, tuple(names), places + height + wobble, "m", "+z")
    search = Search(population=10, generations=2, frames=_FRAMES)
    calibrate([recording], MarkerSet("warm-up", segments, {}), arm.name, search=search)
    markers = tuple(
        Marker(name, joint, (float(x), float(y), float(z)))
        for name, joint, (x, y, z) in zip(names, links, places, strict=True)
    )
    track_limb(replace(arm, markers=markers, base=Base(segment=where.base)), [recording])
