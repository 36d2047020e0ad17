"""One fit of a simulated leg for all tests of the room."""

from dataclasses import dataclass

import pytest

from benchmarks.simulated_people.person import Person, person
from fitter.limb.limb_calibration import calibrate
from fitter.limb.limb_fit import LimbFit


@dataclass(frozen=True)
class Leg:
    """A leg with a known truth, and what a fit of its two trials found."""

    truth: Person
    fit: LimbFit


@pytest.fixture(scope="session")
def leg() -> Leg:
    truth = person("human-leg-right", trials=2, n=200, seed=7)
    return Leg(truth, calibrate(truth.recordings, truth.marker_set, "human-leg-right", fit_frames=120))
