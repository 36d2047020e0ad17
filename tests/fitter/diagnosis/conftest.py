"""The driven arm that diagnoses are of."""

from dataclasses import replace

import pytest

from arm.model import Arm, Effect, Friction
from fitter.data.trial import Trial
from tests.fitter.driven import TRUE, driven_trials


@pytest.fixture(scope="session")
def true_arm() -> Arm:
    """Return the arm that moved."""
    return TRUE


@pytest.fixture(scope="session")
def wrong_arm() -> Arm:
    """Return an arm whose rotor and elbow's friction are wrong."""
    wrong = replace(TRUE.joints[1], friction=Friction(0.01, 0.03))
    rotor = Effect("rotor_inertia", {"inertia_kg_m2": 0.002}, joints=(2,))
    return replace(TRUE, joints=(TRUE.joints[0], wrong), effects=(rotor,))


@pytest.fixture(scope="session")
def trials() -> list[Trial]:
    """Return two trials of the arm that moved, angles with noise."""
    return driven_trials(TRUE, 2, 2e-4)
