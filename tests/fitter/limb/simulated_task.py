"""A bundle fit's task on a simulated leg whose geometry, marker places and angles are known."""

from dataclasses import dataclass, replace

import numpy as np

from arm.body.landmarks import limb_map
from arm.body.limbs import MEAN_PERSON, limb
from arm.model import Arm, Floats
from fitter.limb.bundle import Prior, Task
from fitter.limb.free_geometry import FreeGeometry, Geometry, free_geometry, geometry_of
from fitter.limb.initial_geometry import angle_prior
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import SWAY, Frames, MarkerModel

_NOISE_M, _STD_M = 1e-3, 8e-3


@dataclass(frozen=True)
class KnownTask:
    """The truth, and the task that it was drawn for."""

    arm: Arm
    task: Task
    geometry: Geometry
    markers: MarkerModel
    q: Floats


def simulated_task(n: int = 10, seed: int = 0) -> KnownTask:
    """Return frames a second apart of a leg with four markers a segment, whose prior is off as it says."""
    rng = np.random.default_rng(seed)
    arm = limb(replace(MEAN_PERSON, preset="human-leg-right"))
    where = limb_map(arm.name, arm.n_joint)
    free: FreeGeometry = free_geometry(arm, 0.05, (0.03, 0.03))
    prior = geometry_of(arm)
    true = prior.moved(free, 0.7 * free.std * rng.standard_normal(len(free.std)))
    links = np.repeat([part.link for part in where.parts.values()], 4).astype(np.int64)
    place = rng.uniform(-0.15, 0.15, (len(links), 3))
    names = tuple(f"m{k}" for k in range(len(links)))
    markers = MarkerModel(names, links, place, np.full(len(links), _STD_M))
    angles = angle_prior(arm, where, 0.0)
    low, high = np.array([joint.limits for joint in arm.joints]).T
    q = np.zeros((n, SWAY + arm.n_joint))
    q[:, SWAY:] = rng.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high, (n, arm.n_joint))
    R, p = np.tile(np.eye(3), (n, 1, 1)), rng.uniform(-0.1, 0.1, (n, 3))
    frames = Frames(np.empty((n, len(links), 3)), R, p, np.zeros(n, dtype=np.int64), np.arange(float(n)))
    y = predicted(markers.chain(true), frames, q) + _NOISE_M * rng.standard_normal((n, len(links), 3))
    place_std = np.full(3 * len(links), 0.05)
    about = place + 0.02 * rng.standard_normal(place.shape)
    task = Task(
        free, frames._replace(y=y), np.ones(n), np.zeros(n, dtype=np.int64),
        Prior(prior, about, np.concatenate([free.std, place_std]) ** -2), angles,
    )  # fmt: skip
    return KnownTask(arm, task, true, markers, q)
