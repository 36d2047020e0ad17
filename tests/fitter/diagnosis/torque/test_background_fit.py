"""The background is estimated from residuals, by slopes that are those of the likelihood."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.least_squares import ODDS_NATS
from fitter.diagnosis.torque.background import Background, log_likelihood
from fitter.diagnosis.torque.background_fit import estimated, log_likelihood_slopes
from tests.fitter.diagnosis.torque.residuals import drawn, trial


def background(**changed: float) -> Background:
    numbers = {
        "std": 0.05, "time_constant_s": 0.3, "ringing": 0.02, "ringing_rad_s": 20.0, "damping_ratio": 0.3,
        "white": 0.01, "angle": 1e-6, "degrees_of_freedom": 30.0, "contact": 0.03,
    }  # fmt: skip
    signals = {"in_proportion": np.array([0.1, 0.2]), "proportion_s": np.array([0.5, 1.0])}
    return Background(**{**numbers, **changed}, **signals)


@pytest.mark.parametrize("damping_ratio", [0.3, 1.0])
def test_the_slopes_are_the_differences_of_the_likelihood(damping_ratio: float):
    parts = [trial(np.random.default_rng(seed)).rows(0) for seed in (1, 2)]
    parts[0].known[20:40] = False
    model = background(damping_ratio=damping_ratio, degrees_of_freedom=3.0)
    value, slopes = log_likelihood_slopes(model, parts)
    assert value == pytest.approx(log_likelihood(model, parts))
    for k, number in enumerate(model.numbers):
        step = np.where(np.arange(len(slopes)) == k, 1e-5 * number, 0.0)
        near = [log_likelihood(Background.of(model.numbers - times * step), parts) for times in range(3)]
        difference = (3.0 * near[0] - 4.0 * near[1] + near[2]) / (2.0 * step[k])
        assert slopes[k] * number == pytest.approx(difference * number, rel=1e-3, abs=1e-4)


def test_the_size_and_the_time_of_a_process_are_found():
    rng = np.random.default_rng(2)
    parts = [trial(rng).rows(0) for _ in range(4)]
    found = estimated(parts)
    noiseless = background(ringing=1e-5, white=0.01, contact=1e-6)
    truth = replace(noiseless, in_proportion=np.full(2, 1e-6), proportion_s=np.ones(2))
    assert np.hypot(found.std, found.ringing) == pytest.approx(0.05, rel=0.35)
    assert found.degrees_of_freedom > 8.0
    gained = sum(log_likelihood(found, [part]) - log_likelihood(truth, [part]) for part in parts)
    assert gained > 0.0


def test_an_estimate_goes_on_from_another():
    part = trial(np.random.default_rng(3)).rows(0)
    first = estimated([part])
    again = estimated([part], first)
    assert log_likelihood(again, [part]) >= log_likelihood(first, [part]) - 0.1


@pytest.mark.filterwarnings("error")
def test_an_arm_that_swings_freely_has_no_errors_of_its_torque():
    free = replace(trial(np.random.default_rng(4)), torque=np.zeros((250, 1))).rows(0)
    found = estimated([free])
    again = estimated([free], found)
    assert np.all(again.in_proportion == 0.0)
    assert np.isfinite(log_likelihood(again, [free]))


def test_what_strikes_where_the_torque_changes_its_sign_is_found():
    rng = np.random.default_rng(6)
    parts = [trial(rng).rows(0) for _ in range(4)]
    for part in parts:
        part.r[:] += 0.5 * part.reversing * rng.normal(size=len(part.r))
    found = estimated(parts)
    assert found.contact == pytest.approx(0.5, rel=0.35)
    assert np.hypot(found.std, found.ringing) == pytest.approx(0.05, rel=0.5)


@pytest.mark.parametrize("ringing_rad_s", [8.0, 20.0, 50.0])
def test_ringing_is_found_at_any_frequency_beside_a_large_signal(ringing_rad_s: float):
    rng = np.random.default_rng(2)
    part = trial(rng).rows(0)
    curved = np.diff(rng.standard_normal(len(part.r) + 2), 2) / np.sqrt(6.0)  # of variance one
    rings = background(std=0.02, ringing=0.1, ringing_rad_s=ringing_rad_s, damping_ratio=0.1, contact=1e-3)
    signals = {"in_proportion": np.array([1e-3, 1e-3, 0.5]), "proportion_s": np.array([1.0, 1.0, 5.0])}
    truth = replace(rings, **signals)
    rows = [drawn(truth, replace(part, signals=np.column_stack([part.signals, curved])), rng)]
    nearest = estimated(rows, truth)
    assert log_likelihood(estimated(rows), rows) > log_likelihood(nearest, rows) - ODDS_NATS
