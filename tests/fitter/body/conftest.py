"""One fit of a simulated person for all tests of the room."""

import pytest

from fitter.body.calibration import calibrate_body
from fitter.body.document import body_document
from tests.fitter.body.simulated_body import truth


@pytest.fixture(scope="session")
def person():
    return truth()


@pytest.fixture(scope="session")
def fit(person):
    return calibrate_body([person.recording], person.marker_set, fit_frames=60)


@pytest.fixture(scope="session")
def found(person, fit):
    return body_document(fit, [person.recording], [], 0)
