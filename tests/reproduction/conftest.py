"""What takes long to compute and several tests look at."""

import pytest

from reproduction.experiment import Experiment, Settings
from reproduction.fig8 import run


@pytest.fixture(scope="session")
def fig8() -> Experiment:
    """Return Fig. 8, small."""
    return run(Settings(quick=True))
