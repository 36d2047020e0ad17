"""A trial that has all that a trial can have."""

import numpy as np
import pytest

from arm.drive_state import DriveState
from fitter.data.trial import Trial
from tests.fitter.data.random_columns import CLOCK, DDQ, DQ, DT_S, TAU, N, Q


@pytest.fixture
def full():
    state = DriveState(np.ones((N, 2), dtype=bool), Q, DQ)
    return Trial(
        *("run", CLOCK, DT_S, Q, DQ, DDQ, TAU, Q + 1.0, np.hstack([Q, TAU[:, :1]])),
        **{"points": np.stack([Q, TAU], axis=2), "ref_filtered": Q + 2.0, "tau_measured": TAU - 1.0},
        **{"drives": state, "contradicted": Q > 0.0, "trimmed": 5, "began_s": 3.0, "whole": {"q": Q, "on": Q}},
    )
