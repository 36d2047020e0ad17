"""What the cases' own search tries beside what it has found."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from examples.cases.search import _is_founded
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.model import Model


@pytest.mark.parametrize(
    ("denied", "found_at", "tried"),
    [(("D", "fc"), (), False), (("D", "fc"), (1,), False), (("D", "fc"), (0,), True), ((), (), True)],
)
def test_friction_falls_only_to_a_friction_that_is_there(
    denied: tuple[str, ...], found_at: tuple[int, ...], tried: bool
) -> None:
    model = Model()
    for joint in found_at:
        model = model.plus(AtJoint(catalogue()["coulomb"], joint), np.zeros(0))
    assert _is_founded(AtJoint(catalogue()["stribeck"], 0), model, denied) is tried
    assert _is_founded(AtJoint(catalogue()["coulomb"], 0), model, denied)
