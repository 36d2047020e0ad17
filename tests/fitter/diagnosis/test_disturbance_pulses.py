"""Pushes as a hypothesis: known torques, and names that tell them apart."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.motion import as_measured
from fitter.diagnosis.torque.pulse import Pulse

KIND = catalogue()["external_push"]
PULSE = Pulse(0, 0, 1.0, 0.2, 5.0, 0.01, 0.02, 0.3, 0.1, "rectangular", 20.0, 15.0)
OTHER = replace(PULSE, start_s=1.5, duration_s=0.4, torque_N_m=-6.0, form="bell")


def test_a_push_is_a_torque_beside_the_drives():
    q = np.zeros((300, 2))
    motion = SimpleNamespace(t=0.01 * np.arange(300), dt_s=0.01, q=q, dq=q, ddq=q, u=q + 1.0, direction=q)
    hypothetical = DisturbancePulses(KIND, 1, [PULSE, OTHER]).act(as_measured(motion, None), np.zeros(0))
    assert np.all(hypothetical.u[:, 0] == 1.0)
    assert hypothetical.u[110, 1] == pytest.approx(6.0)
    assert (hypothetical.u[:, 1] - 1.0).sum() * motion.dt_s == pytest.approx(5.0 * 0.2 - 6.0 * 0.4)
    assert np.all(motion.u == 1.0)


def test_each_of_several_has_its_own_numbers():
    pushes, nothing = DisturbancePulses(KIND, 0, [PULSE, OTHER]), np.zeros(0)
    assert pushes.numbers(nothing, nothing).tolist() == [1.0, 0.2, 5.0, 1.5, 0.4, -6.0]
    assert pushes.hidden([], np.zeros(6)).tolist() == [0.01, 0.02, 0.3] * 2
    assert (
        pushes.names[:3] == ("start_s_1", "duration_s_1", "torque_N_m_1") and len(pushes.units_at("revolute")) == 6
    )
    assert DisturbancePulses(KIND, 0, [PULSE]).names == ("start_s", "duration_s", "torque_N_m")
