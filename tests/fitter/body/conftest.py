"""One fit of a simulated person for all tests of the room."""

import pytest

from benchmarks.simulated_people.body import fitted
from fitter.body.document import body_document
from fitter.limb.marker_errors import scores_of


@pytest.fixture(scope="session")
def person():
    return fitted()[0]


@pytest.fixture(scope="session")
def fit():
    return fitted()[1]


@pytest.fixture(scope="session")
def found(person, fit):
    return body_document(fit, scores_of(fit, [person.recording], [], 0))
