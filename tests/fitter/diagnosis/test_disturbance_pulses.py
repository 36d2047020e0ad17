"""Pushes as a hypothesis: impulses and ends that are fitted, and names that tell them apart."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.motion import as_measured
from fitter.diagnosis.sharp_columns import behind_filter
from fitter.diagnosis.torque.pulse import Pulse

KIND = catalogue()["external_push"]
PULSE = Pulse(0, 0, 1.0, 0.2, 5.0, 0.01, 0.02, 0.3, 0.1, "rectangular", 20.0, 15.0)
OTHER = replace(PULSE, start_s=1.5, duration_s=0.4, torque_N_m=-6.0, form="bell")


def resting(n=300):
    t, q = 0.01 * np.arange(n), np.zeros((n, 2))
    trial = SimpleNamespace(t=t, dt_s=0.01, cutoff_hz=np.inf, trimmed=0)
    return SimpleNamespace(trial=trial, t=t, dt_s=0.01, q=q, dq=q, ddq=q, u=q + 1.0, direction=q)


def acting(hypothesis, psi, motion=None):
    motion = motion or resting()
    hypothetical = hypothesis.act(as_measured(motion, None), psi)
    assert np.all(hypothetical.u == 1.0)
    return hypothetical.columns[0]


def test_a_push_is_an_impulse_beside_the_drives():
    pushes = DisturbancePulses(KIND, 1, [PULSE, OTHER])
    columns = acting(pushes, pushes.starts([])[0])
    assert columns.shape == (300, 2, 2) and np.all(columns[:, 0] == 0.0)
    np.testing.assert_allclose(0.01 * columns[:, 1].sum(axis=0), -1.0)
    assert columns[110, 1, 0] == pytest.approx(-1.0 / 0.2)


def test_its_ends_move_with_psi():
    push = DisturbancePulses(KIND, 0, [PULSE])
    assert push.n_number == 3 and np.all(push.low < 1.0) and np.all(push.high > 1.0)
    column = acting(push, np.array([0.9, 1.2]))[:, 0, 0]
    assert np.flatnonzero(column)[[0, -1]].tolist() == [98, 124]
    assert push.numbers(np.array([0.9, 1.2]), np.array([0.52])) == pytest.approx([0.98, 0.26, 2.0])


def test_only_the_push_that_moved_is_filtered_anew(monkeypatch):
    made, motion, push = list[object](), resting(), DisturbancePulses(KIND, 1, [PULSE, OTHER])
    monkeypatch.setattr(
        "fitter.diagnosis.disturbance_pulses.behind_filter",
        lambda *given: made.append(given) or behind_filter(*given),
    )
    for psi in (np.ones(4), np.array([1.0, 1.0, 1.2, 1.0])):
        again = DisturbancePulses(KIND, 1, [PULSE, OTHER])
        np.testing.assert_array_equal(acting(push, psi, motion), acting(again, psi))
    assert len([one for one in made if one[0] is motion]) == 3
    short = resting(50)  # over before either begins
    assert not np.any(acting(push, np.ones(4), short))


def test_an_unseen_end_is_not_fitted():
    push = DisturbancePulses(KIND, 0, [replace(PULSE, unseen_s=(0.12, 0.0))])
    assert push.n_number == 2
    assert push.numbers(np.array([1.5]), np.array([1.5])) == pytest.approx([1.0, 0.3, 5.0])


def test_its_errors_are_those_with_which_it_was_found():
    push = DisturbancePulses(KIND, 0, [PULSE])
    errors = [PULSE.start_std, PULSE.duration_std, PULSE.torque_std]
    assert push.standard_errors(np.full(3, 9.0), []).tolist() == errors


def test_pulses_are_where_psi_and_impulses_have_them():
    push = DisturbancePulses(KIND, 1, [PULSE, OTHER])
    psi, impulses = np.array([1.0, 1.2, 0.9, 1.0]), np.array([0.8, -0.3])
    found = push.pulses(psi, impulses)
    numbers = [(one.start_s, one.duration_s, one.torque_N_m) for one in found]
    assert np.ravel(numbers) == pytest.approx(push.numbers(psi, impulses))
    assert [one.form for one in found] == [PULSE.form, OTHER.form]


def test_a_torque_that_may_be_none_is_not_determined():
    pushes, values = DisturbancePulses(KIND, 0, [PULSE, OTHER]), np.array([1.0, 0.2, 5.0, 1.5, 0.4, -6.0])
    std = np.array([0.01, 0.11, 5.0, 0.8, 0.9, 2.0])
    assert pushes.determined(values, std).tolist() == [True, True, False, True, True, True]


def test_the_torque_of_a_push_that_begins_unseen_is_determined():
    begun = replace(PULSE, unseen_s=(1.0, 0.0))
    pushes = DisturbancePulses(KIND, 0, [begun])
    error = float(np.hypot(1.0 / np.sqrt(12.0), 0.01))
    assert pushes.determined(np.array([1.0, 0.4, 5.0]), np.array([error, error, 0.1])).tolist() == [
        True,
        True,
        True,
    ]


def test_each_of_several_has_its_own_numbers():
    pushes = DisturbancePulses(KIND, 0, [PULSE, OTHER])
    assert pushes.numbers(np.ones(4), np.array([1.0, -2.4])) == pytest.approx([1.0, 0.2, 5.0, 1.5, 0.4, -6.0])
    assert pushes.names[:3] == ("start_s_1", "duration_s_1", "torque_N_m_1")
    assert len(pushes.units_at("revolute")) == 6
    assert DisturbancePulses(KIND, 0, [PULSE]).names == ("start_s", "duration_s", "torque_N_m")
    samples = [SimpleNamespace(t=np.zeros(500))] * 2
    assert pushes.log_places(samples) == pytest.approx(2.0 * np.log(1000.0))
