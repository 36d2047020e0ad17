"""A motion to be written, with a twin and without, of several arms."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from playback.export.sampled import Sampled, sample
from playback.source import Source
from playback.trajectory import Trajectory

SLIDING = Arm(
    "sliding",
    (
        Joint("prismatic", d_m=0.1, alpha_rad=0.4),
        Joint(a_m=0.3, alpha_rad=1.2, beta_rad=-0.3),
        Joint("prismatic", a_m=0.1, theta_offset_rad=0.7),
    ),
)


def waves(arm: Arm, duration_s: float = 0.5, size: float = 0.6) -> Trajectory:
    t = np.linspace(0.0, duration_s, 251)[:, None]
    w = 9.0 + 2.0 * np.arange(arm.n_joint)
    q, dq, ddq = size * np.sin(w * t), size * w * np.cos(w * t), -size * w**2 * np.sin(w * t)
    return Trajectory(t[:, 0], q, dq, ddq, "file")


def source_of(arm: Arm, twin: bool = False) -> Source:
    motions = {1: waves(arm), 4: waves(arm, 0.3)}
    source = Source("waves.csv", arm, {n: motion.duration_s for n, motion in motions.items()}, motions.__getitem__)
    if not twin:
        return source
    smaller = {n: waves(arm, motion.duration_s, 0.5) for n, motion in motions.items()}
    return replace(source, twin=replace(source, trajectory=smaller.__getitem__))


@pytest.fixture(params=["dd-arm", "dd-arm-vertical", "spatial-arm", "examples/human-arm.toml", "sliding"])
def any_arm(request: pytest.FixtureRequest) -> Arm:
    return SLIDING if request.param == "sliding" else load_arm(request.param)


@pytest.fixture
def motion(any_arm: Arm) -> Sampled:
    return sample(source_of(any_arm), None, 60.0, 1.0)


@pytest.fixture(scope="session")
def pair() -> Sampled:
    """Return the bench arm beside its twin."""
    return sample(source_of(load_arm("dd-arm"), twin=True), None, 60.0, 1.0)
