"""Sensors that are mounted not quite as the arm file says, found out from motions."""

from dataclasses import replace

import numpy as np
import pytest

from arm.bench import Bench, Sensors, draw_sensor_errors, motions
from arm.counts import COUNT_M_S2
from fitter.data.raw import RawRun
from fitter.sensing.sensors import fit_sensors
from fitter.sensing.track import track_run
from tracking.model.initial_state import MountingPrior

RATE_HZ = 4000.0


def moved(arm, errors, seed, trials):
    """Return readings of some motions of the bench, and the angles."""
    rng, bench = np.random.default_rng(seed), Bench(rate_hz=RATE_HZ, learning=trials, evaluating=0)
    sensors = Sensors(arm, errors, RATE_HZ, rng)
    trials = list(motions(arm, bench, seed))
    a = COUNT_M_S2 * np.concatenate([sensors.counts(motion) for motion in trials])
    return RawRun(
        f"seed {seed}", RATE_HZ, np.arange(len(a)) / RATE_HZ, a, q=np.concatenate([motion.q for motion in trials])
    )


@pytest.fixture(scope="module")
def errors(short_run):
    """Return errors three times as large as those of the bench's imperfect mounting."""
    drawn = draw_sensor_errors(short_run.arm, np.random.default_rng(3), imperfect_mounting=True)
    return replace(
        drawn,
        scale=1.0 + 3.0 * (drawn.scale - 1.0),
        misalignment_rad=3.0 * drawn.misalignment_rad,
        offset_m=3.0 * drawn.offset_m,
    )


@pytest.fixture(scope="module")
def fit(short_run, errors):
    ticks = iter(range(10))
    run = moved(short_run.arm, errors, 3, 3)
    return fit_sensors(short_run.arm, [run], np.zeros(2), MountingPrior(), clock=lambda: float(next(ticks)))


def test_what_was_revealed_is_true_to_four_standard_errors(fit, short_run, errors):
    true = {
        "bias": errors.bias_m_s2,
        "scale": errors.scale,
        "turn": errors.misalignment_rad,
        "place": errors.offset_m,
    }
    revealed = 0
    for k, sensor in enumerate(short_run.arm.sensors):
        numbers = fit.parameters()[sensor.name]
        assert list(numbers) == [f"{kind}_{axis}" for kind in true for axis in "xyz"]
        for kind, values in true.items():
            for axis, value in zip("xyz", values[k], strict=True):
                number = numbers[f"{kind}_{axis}"]
                assert not number.identifiable or abs(number.value - value) < 4.0 * number.std
                revealed += number.identifiable
    assert revealed > 16


def test_what_a_flat_arm_never_shows_is_left_and_said(fit, short_run):
    """No motion about the vertical tells how high a sensor sits."""
    for before, sensor in zip(short_run.arm.sensors, fit.arm.sensors, strict=True):
        height = fit.parameters()[sensor.name]["place_z"]
        assert not height.identifiable and height.value == pytest.approx(0.0, abs=1e-5)
        assert sensor.position_m[2] == pytest.approx(before.position_m[2], abs=1e-5)
        assert any(f"{sensor.name} place_z" in sentence for sentence in fit.calibration.hidden)


def test_the_next_motion_is_tracked_better(fit, short_run, errors):
    held_out = moved(short_run.arm, errors, 53, 2)
    before, after = (
        track_run(held_out, arm, np.zeros(2), 1000.0, "smooth").error_deg.max() for arm in (short_run.arm, fit.arm)
    )
    assert after < 0.6 * before


def test_the_document_holds_every_number(fit):
    document = fit.document()
    names = {"sensors", "not_revealed", "lengths", "passes", "converged", "doubted", "samples", "seconds", "axes"}
    assert set(document) == names
    assert set(document["sensors"]) == {"s1", "s2", "s3", "s4"}
    assert set(document["sensors"]["s1"]["turn_z"]) == {"value", "std", "unit", "identifiable"}
    assert (document["samples"], document["seconds"], document["converged"]) == (81000, 1.0, True)
    assert document["doubted"] < 0.01


def test_several_runs_tell_more_than_one(short_run):
    errors = draw_sensor_errors(short_run.arm, np.random.default_rng(3), imperfect_mounting=True)
    runs = [moved(short_run.arm, errors, seed, 1) for seed in (3, 4)]
    passes = []
    one, both = (
        fit_sensors(short_run.arm, some, np.zeros(2), MountingPrior(), progress=passes.append)
        for some in (runs[:1], runs)
    )
    assert both.samples == 2 * one.samples
    assert passes and passes[0] == 1
    for sensor, numbers in both.parameters().items():
        for name, number in numbers.items():
            assert number.std <= 1.05 * one.parameters()[sensor][name].std
