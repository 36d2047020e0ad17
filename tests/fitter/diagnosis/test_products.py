"""Products of simple functions are what they are called."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fitter.diagnosis.motion import Motion
from fitter.diagnosis.products import products, spelled

RNG = np.random.default_rng(6)
MOTION = cast(Motion, SimpleNamespace(t=np.arange(50.0), q=RNG.normal(size=(50, 2)), dq=RNG.normal(size=(50, 2))))


@pytest.mark.parametrize(
    ("some", "name", "values"),
    [
        (("q1",), "q1^3", MOTION.q[:, 0] ** 3),
        (("dq2",), "dq2|dq2|", MOTION.dq[:, 1] * np.abs(MOTION.dq[:, 1])),
        (("t", "sign(dq1)"), "t sign(dq1)", MOTION.t * np.sign(MOTION.dq[:, 0])),
        (("dq1", "sign(dq2)"), "|dq1| sign(dq2)", np.abs(MOTION.dq[:, 0]) * np.sign(MOTION.dq[:, 1])),
        (
            ("q1", "dq1", "q2"),
            "sin(q1) dq1 cos(q2)",
            np.sin(MOTION.q[:, 0]) * MOTION.dq[:, 0] * np.cos(MOTION.q[:, 1]),
        ),
    ],
)
def test_a_product_is_what_it_is_called(some, name, values):
    columns, written = products(MOTION, some), spelled(some)
    assert columns.shape == (50, len(written))
    assert len(set(written)) == len(written)
    assert np.allclose(columns[:, written.index(name)], values)
