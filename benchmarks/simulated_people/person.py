"""A person's limb with a known truth: a preset bent a little, markers on it, a motion, a base that moves."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from arm.body.landmarks import landmark_places, limb_map, middle_of
from arm.body.limbs import MEAN_PERSON, limb
from arm.kinematics import axis_frames
from arm.model import Arm, Base, Floats, Marker
from fitter.functional.marker_set import MarkerSet
from protocol.markers.recording import MarkerRecording

RATE_HZ = 50.0


@dataclass(frozen=True)
class Person:
    """The truth, and what was recorded of it."""

    arm: Arm
    recordings: tuple[MarkerRecording, ...]
    marker_set: MarkerSet
    q: tuple[Floats, ...]
    R: tuple[Floats, ...]
    p: tuple[Floats, ...]
    base_p: Floats


def wander(rng: np.random.Generator, n: int, seconds: float, columns: int, rate_hz: float = RATE_HZ) -> Floats:
    """Return smooth noise of rms one, (n, columns)."""
    raw = gaussian_filter1d(rng.normal(size=(n + 400, columns)), seconds * rate_hz, axis=0)[200:-200]
    return raw / np.sqrt(np.mean(raw**2, axis=0))


def person(
    preset: str = "human-arm-right",
    seed: int = 0,
    n: int = 600,
    trials: int = 1,
    noise_m: float = 5e-4,
    rate_hz: float = RATE_HZ,
    cluster: int = 3,
) -> Person:
    """Simulate a person with ``cluster`` markers a segment; its lengths and its axes are not the preset's."""
    rng = np.random.default_rng(seed)
    spread = 0.05 * np.vstack([np.diag([1.0, -1.0, 1.0]), np.random.default_rng(7).normal(size=(cluster, 3))])
    arm = limb(replace(MEAN_PERSON, preset=preset), "scapula")
    numbers = {name: np.array([getattr(j, name) for j in arm.joints]) for name in ("alpha_rad", "a_m", "d_m")}
    numbers["d_m"][2] *= 1.05
    is_arm = "arm" in preset
    if is_arm:
        numbers["d_m"][4] *= 0.96
        numbers["alpha_rad"][3:7] += [0.06, -0.05, 0.04, -0.05]
        numbers["a_m"][3:5] = [0.004, -0.003]
    else:
        numbers["a_m"][3] *= 0.96
        numbers["alpha_rad"][4:6] += [0.05, -0.2]
    arm = arm.with_joints(**numbers)
    where = limb_map(preset, arm.n_joint)
    base_p = np.array([0.02, -0.03, -0.06])
    landmarks = {k: v for k, v in landmark_places(arm, where, 1.741).items() if v[0] >= 0}
    segments: dict[str, tuple[str, ...]] = {where.base: ("B1", "B2", "B3", "B4")}
    names, links, places = [], [], []
    for segment, part in where.parts.items():
        own = [f"{segment}{k}" for k in range(cluster)]
        segments[segment] = tuple(own)
        for k, name in enumerate(own):
            names.append(name)
            links.append(part.link)
            places.append(middle_of(arm, where, segment) + spread[k])
    for name, (link, place) in landmarks.items():
        names.append(name)
        links.append(link)
        places.append(place)
    base_points = np.array([[0.05, 0.0, 0.0], [-0.05, 0.02, 0.0], [0.0, 0.06, 0.03], [0.0, -0.05, 0.04]])
    qs, Rs, ps, recordings = [], [], [], []
    low, high = np.array([joint.limits for joint in arm.joints]).T
    for k in range(trials):
        q = 0.5 * (low + high) + 0.22 * (high - low) * wander(rng, n, 0.5, arm.n_joint, rate_hz)
        q[:, 1] = 0.2 + 0.35 * wander(rng, n, 0.5, 1, rate_hz)[:, 0]  # clear of gimbal lock
        R = Rotation.from_rotvec(0.15 * wander(rng, n, 1.0, 3, rate_hz)).as_matrix()
        p = 0.05 * wander(rng, n, 1.0, 3, rate_hz) + [0.3, 0.2, 1.2]
        frames = axis_frames(arm, q)
        at = [frames[:, i, :3, :3] @ x + frames[:, i, :3, 3] + base_p for i, x in zip(links, places, strict=True)]
        everything = np.concatenate([np.stack(at, axis=1), np.tile(base_points, (n, 1, 1))], axis=1)
        world = np.einsum("nij,nmj->nmi", R, everything) + p[:, None]
        world += noise_m * rng.normal(size=world.shape)
        all_names = (*names, *segments[where.base])
        recordings.append(MarkerRecording(f"trial{k}.trc", rate_hz, all_names, world, "m", "+z"))
        qs.append(q)
        Rs.append(R)
        ps.append(p)
    marker_set = MarkerSet("simulated", segments, {name: name for name in landmarks})
    return Person(arm, tuple(recordings), marker_set, tuple(qs), tuple(Rs), tuple(ps), base_p)


def with_gaps(recording: MarkerRecording, rng: np.random.Generator, share: float = 0.15) -> MarkerRecording:
    """Return a recording whose markers come and go, for a quarter of a second at a time."""
    positions = recording.positions.copy()
    block = int(0.25 * RATE_HZ)
    lost = rng.random((len(positions) // block + 1, positions.shape[1])) < share
    positions[np.repeat(lost, block, axis=0)[: len(positions)]] = np.nan
    return replace(recording, positions=positions)


def with_markers(truth):
    """Return the true arm with its markers where they are, as a calibration would write it."""
    first, R, p = truth.recordings[0].positions[0], truth.R[0][0], truth.p[0][0]
    frames = axis_frames(truth.arm, truth.q[0][:1])[0]
    in_frame_0 = (first - p) @ R - truth.base_p
    markers = []
    for name, x in zip(truth.recordings[0].names, in_frame_0, strict=True):
        joint = 0 if name.startswith("B") else _link_of(name)
        at = x if joint == 0 else frames[joint - 1, :3, :3].T @ (x - frames[joint - 1, :3, 3])
        markers.append(Marker(name, joint, tuple(at.tolist()), 0.004))
    base = Base(tuple(truth.base_p.tolist()), (0.0, 0.0, 0.0), "scapula_right")
    return replace(truth.arm, markers=tuple(markers), base=base)


def _link_of(name):
    if name.startswith(("upper", "lateral", "medial")):
        return 3
    return 5 if name.startswith(("forearm", "radial", "ulnar")) else 7
