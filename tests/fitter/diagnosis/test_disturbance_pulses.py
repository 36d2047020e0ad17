"""Pushes as a hypothesis: impulses that are fitted where they were found, and names by number."""

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


def acting(hypothesis, motion=None):
    motion = motion or resting()
    hypothetical = hypothesis.act(as_measured(motion, None), np.zeros(0))
    assert np.all(hypothetical.u == 1.0)
    return hypothetical.columns[0]


def test_a_push_is_an_impulse_beside_the_drives():
    pushes = DisturbancePulses(KIND, 1, [PULSE, OTHER])
    columns = acting(pushes)
    assert columns.shape == (300, 2, 2) and np.all(columns[:, 0] == 0.0)
    np.testing.assert_allclose(0.01 * columns[:, 1].sum(axis=0), -1.0)
    assert columns[110, 1, 0] == pytest.approx(-1.0 / 0.2)


def test_a_push_is_where_it_was_found():
    push = DisturbancePulses(KIND, 0, [PULSE])
    assert push.n_number == 3 and len(push.starts([])[0]) == 0
    assert np.flatnonzero(acting(push)[:, 0, 0])[[0, -1]].tolist() == [100, 120]
    assert push.numbers(np.zeros(0), np.array([0.52])) == pytest.approx([1.0, 0.2, 2.6])


def test_its_column_is_filtered_once_a_motion(monkeypatch):
    made, motion, push = list[object](), resting(), DisturbancePulses(KIND, 1, [PULSE, OTHER])
    monkeypatch.setattr(
        "fitter.diagnosis.disturbance_pulses.behind_filter",
        lambda *given: made.append(given) or behind_filter(*given),
    )
    np.testing.assert_array_equal(acting(push, motion), acting(push, motion))
    assert len(made) == 2
    short = resting(50)  # over before either begins
    assert not np.any(acting(push, short))


def test_an_unseen_end_is_no_number():
    assert DisturbancePulses(KIND, 0, [replace(PULSE, unseen_s=(0.12, 0.0))]).n_number == 2


def test_its_errors_are_those_with_which_it_was_found():
    push = DisturbancePulses(KIND, 0, [PULSE])
    errors = [PULSE.start_std, PULSE.duration_std, PULSE.torque_std]
    assert push.standard_errors(np.full(3, 9.0), []).tolist() == errors


def test_pulses_have_the_torques_of_their_impulses():
    push = DisturbancePulses(KIND, 1, [PULSE, OTHER])
    impulses = np.array([0.8, -0.3])
    found = push.pulses(impulses)
    numbers = [(one.start_s, one.duration_s, one.torque_N_m) for one in found]
    assert np.ravel(numbers) == pytest.approx(push.numbers(np.zeros(0), impulses))
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
    assert pushes.numbers(np.zeros(0), np.array([1.0, -2.4])) == pytest.approx([1.0, 0.2, 5.0, 1.5, 0.4, -6.0])
    assert pushes.names[:3] == ("start_s_1", "duration_s_1", "torque_N_m_1")
    assert len(pushes.units_at("revolute")) == 6
    assert DisturbancePulses(KIND, 0, [PULSE]).names == ("start_s", "duration_s", "torque_N_m")
    samples = [SimpleNamespace(t=np.zeros(500))] * 2
    assert pushes.log_places(samples) == pytest.approx(2.0 * np.log(1000.0))
