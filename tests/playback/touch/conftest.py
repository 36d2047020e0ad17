"""A haptic loop in a process of its own."""

from collections.abc import Iterator

import numpy as np
import pytest
import zmq

from arm.arm_file import load_arm
from playback.touch.limit import Coupling
from playback.touch.process import TouchProcess


@pytest.fixture(scope="module")
def loop() -> Iterator[TouchProcess]:
    """Return one for a whole file: whoever changes its arm puts it back."""
    with TouchProcess(load_arm("dd-arm"), np.array([0.3, 0.6]), coupling=Coupling(300.0, 1.0)) as process:
        yield process


@pytest.fixture
def own_context() -> Iterator["zmq.Context[zmq.Socket[bytes]]"]:
    with zmq.Context() as context:
        yield context
