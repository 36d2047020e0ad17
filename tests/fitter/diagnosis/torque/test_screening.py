"""The screening puts the hidden effect first, near its numbers."""

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.in_arm import GravityTilt, RotorInertia
from fitter.diagnosis.model import Model
from fitter.diagnosis.torque.screening import Screening
from tests.fitter.diagnosis.torque.runs import likelihood

COGGING = (Effect("cogging", {"amplitude_N_m": 0.1, "phase_rad": 0.4, "periods_per_turn": 9.0}, joints=(1,)),)


def test_the_hidden_effect_comes_first():
    run, kinds = likelihood(COGGING), catalogue()
    tried = [
        AtJoint(kinds["quadratic_drag"], 0),
        AtJoint(kinds["cogging"], 0),
        RotorInertia(kinds["rotor_inertia"], (0,)),
        GravityTilt(kinds["gravity_tilt"], ()),
    ]
    found = Screening(run, run.judged(run.fit(Model()))).all(tried)
    assert found[0].hypothesis is tried[1]
    np.testing.assert_allclose(found[0].psi, [9.0], atol=1.0)
    assert [one.gain for one in found] == sorted((one.gain for one in found), reverse=True)
    assert found[0].n_start > 1
