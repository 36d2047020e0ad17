"""Arms to try effects on, and what gives them some."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from arm.arm_file import load_arm
from arm.model import Arm, Control, Effect, Floats, Friction, Joint, Link


def _rubbing(arm: Arm, *levels: float) -> Arm:
    return replace(arm, joints=tuple(replace(joint, friction=Friction(*levels)) for joint in arm.joints))


def _having(arm: Arm, name: str, /, joint: int = 1, **numbers: object) -> Arm:
    whole = name in ("payload", "gravity_tilt")
    return replace(arm, effects=(*arm.effects, Effect(name, numbers, () if whole else (joint,))))


def _linear(A: Floats, b: Floats, x0: Floats, t: Floats) -> Floats:
    whole = np.block([[A, b[:, None]], [np.zeros((1, len(b) + 1))]])
    return np.array([(scipy.linalg.expm(whole * instant) @ np.append(x0, 1.0))[: len(b)] for instant in t])


@pytest.fixture(scope="session")
def arm() -> Arm:
    """Return the spatial arm with friction, and gravity that shows where each joint's zero is."""
    return replace(_rubbing(load_arm("spatial-arm"), 0.3, 0.2, 0.0), gravity_m_s2=(2.0, 1.0, -9.5))


@pytest.fixture(scope="session")
def wheel() -> Arm:
    """Return one level joint without friction whose inertia is 0.5 kg m^2."""
    link = Link(1.0, (0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 0.0, 0.0, 0.0))
    return Arm("wheel", (Joint(a_m=0.4, link=link),), control=Control("pd", (8.0,), (-2.0,)))


@pytest.fixture(scope="session")
def having() -> Callable[..., Arm]:
    """Return what gives an arm one more effect, in one of its joints unless it is one of the whole arm."""
    return _having


@pytest.fixture(scope="session")
def rubbing() -> Callable[..., Arm]:
    """Return what gives all joints the same friction: viscous, Coulomb, static."""
    return _rubbing


@pytest.fixture(scope="session")
def held() -> Callable[[float, int], Floats]:
    """Return what makes a target of one joint that stays."""
    return lambda target, n_sample: np.full((n_sample, 1), target)


@pytest.fixture(scope="session")
def linear() -> Callable[..., Floats]:
    """Return what solves ``x' = A x + b`` from ``x0``, at every ``t``."""
    return _linear
