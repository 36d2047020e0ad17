"""Sensors' offsets, scales, turns and places from ordinary motions, against what the bench made them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.bench import Bench, Sensors, draw_sensor_errors, motions, with_errors
from arm.counts import COUNT_M_S2
from arm.kinematics import rotation_from_rpy
from tracking.model.initial_state import MountingPrior
from tracking.model.readings import ReadingsBuilder
from tracking.smoother.self_calibration import calibrate_sensors
from tracking.smoother.smoother import Smoother

RATE_HZ, FRAME_HZ = 4000.0, 250.0
PRIOR = MountingPrior()


def errors_of(arm):
    return draw_sensor_errors(arm, np.random.default_rng([0, 7]), imperfect_mounting=True)


def run(arm, seed, trials=3):
    """Return the readings of a few standard trials, each run with the same imperfect sensors and its own noise."""
    sensors = Sensors(arm, errors_of(arm), RATE_HZ, np.random.default_rng([seed, 8]))
    builder = ReadingsBuilder(RATE_HZ, 3 * len(arm.sensors), FRAME_HZ)
    for motion in motions(arm, Bench(RATE_HZ, learning=trials, evaluating=0), seed):
        builder.push(sensors.counts(motion) * COUNT_M_S2)
    return builder.done()


def truth(arm):
    """Return what every number really is, as the calibration names it."""
    really, found = with_errors(arm, errors_of(arm)), {}
    for said, is_so in zip(arm.sensors, really.sensors, strict=True):
        turned = rotation_from_rpy(*said.rotation_rad).T @ rotation_from_rpy(*is_so.rotation_rad)
        numbers = {
            "bias": is_so.bias_m_s2,
            "scale": is_so.scale,
            "turn": Rotation.from_matrix(turned).as_rotvec(),
            "place": np.subtract(is_so.position_m, said.position_m),
        }
        for kind, values in numbers.items():
            found |= {(said.name, f"{kind}_{axis}"): v for axis, v in zip("xyz", values, strict=True)}
    return found


def missed(arm, calibration):
    """Return by how many standard errors each number is off, and whether it was revealed."""
    true = truth(arm)
    return {
        (e.sensor, e.name): ((e.value - true[e.sensor, e.name]) / e.std, e.revealed) for e in calibration.estimates
    }


@pytest.fixture(scope="module")
def level_run(dd_arm):
    return run(dd_arm, 0)


@pytest.fixture(scope="module")
def level(dd_arm, level_run):
    return calibrate_sensors(dd_arm, [level_run], np.zeros(2), PRIOR)


@pytest.fixture(scope="module")
def twice(dd_arm, level_run):
    told = []
    found = calibrate_sensors(dd_arm, [level_run, run(dd_arm, 5, 2)], np.zeros(2), PRIOR, told.append)
    return found, told


@pytest.fixture(scope="module")
def upright(vertical_arm):
    return calibrate_sensors(vertical_arm, [run(vertical_arm, 0)], None, PRIOR)


def test_what_is_revealed_is_true(dd_arm, vertical_arm, level, upright):
    """Within four standard errors, level and upright; and what is not revealed is within them too."""
    for arm, calibration in ((dd_arm, level), (vertical_arm, upright)):
        misses = missed(arm, calibration)
        assert len(misses) == 4 * 12
        assert max(abs(off) for off, _ in misses.values()) < 4.0
        assert sum(revealed for _, revealed in misses.values()) >= 20
        assert calibration.converged and calibration.doubted < 0.001


def test_gravity_reveals_more(level, upright):
    def shown(calibration):
        return {(e.sensor, e.name) for e in calibration.estimates if e.revealed}

    assert ("s1", "scale_x") in shown(upright) - shown(level)
    assert {("s3", "turn_z"), ("s3", "scale_y"), ("s4", "scale_x")} <= shown(level)


def test_scales_are_not_too_large(dd_arm, vertical_arm, level, upright):
    """A prior on accelerations would rather believe in small motions, and so in sensors that read too much."""
    for arm, calibration in ((dd_arm, level), (vertical_arm, upright)):
        misses = missed(arm, calibration)
        elbow = [misses[name, f"scale_{axis}"][0] for name in ("s3", "s4") for axis in "xy"]
        assert np.abs(elbow).max() < 4.0
        assert np.mean(elbow) < 2.0
    # All four of link 2 read alike what its motion is, so their mean says most of what a prior would do to them.
    values = {(e.sensor, e.name): e for e in level.estimates}
    true = truth(dd_arm)
    keys = [(name, f"scale_{axis}") for name in ("s3", "s4") for axis in "xy"]
    assert abs(np.mean([values[key].value - true[key] for key in keys])) < 0.005


def test_offsets_are_found_best(dd_arm, level):
    """Across the plane to the per cent of gravity that a scale may be off by; in it far better."""
    std = {(e.sensor, e.name): e.std for e in level.estimates}
    for sensor in dd_arm.sensors:
        assert std[sensor.name, "bias_z"] < 9.80665 * PRIOR.scale
        assert std[sensor.name, "bias_y"] < 0.03


def test_units_and_names_are_those_of_the_file(dd_arm, level):
    assert {e.unit for e in level.estimates} == {"m/s^2", "1", "rad", "m"}
    assert [e.sensor for e in level.estimates[::12]] == [sensor.name for sensor in dd_arm.sensors]
    scales = [e.value for e in level.estimates if e.name.startswith("scale")]
    np.testing.assert_allclose(scales, 1.0, atol=0.02)
    assert all(e.std > 0.0 for e in level.estimates)


def test_a_length_between_sensors_is_found(dd_arm, level):
    """Within four standard errors; the far end of the last link moves no sensor and stays as it was."""
    found, true = level.arm.joints, dd_arm.joints
    assert found[0].length_std_m is not None and found[0].length_std_m < 0.002
    assert abs(found[0].a_m - true[0].a_m) < 4.0 * found[0].length_std_m
    assert found[1].a_m == true[1].a_m and level.arm.tip == dd_arm.tip


def test_sensors_are_what_the_estimates_say(dd_arm, level):
    values = {(e.sensor, e.name): e.value for e in level.estimates}
    for before, sensor in zip(dd_arm.sensors, level.arm.sensors, strict=True):
        numbers = {
            "bias": sensor.bias_m_s2,
            "scale": sensor.scale,
            "turn": Rotation.from_matrix(rotation_from_rpy(*sensor.rotation_rad)).as_rotvec(),
            "place": np.subtract(sensor.position_m, before.position_m),
        }
        for kind, found in numbers.items():
            expected = [values[sensor.name, f"{kind}_{axis}"] for axis in "xyz"]
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_places_along_the_axes_are_hidden(dd_arm, level, upright):
    """In a plane nothing shows where along the joints' axes a sensor sits, and it is said of each."""
    for calibration in (level, upright):
        for sensor in dd_arm.sensors:
            assert any(f"{sensor.name} place_z" in sentence for sentence in calibration.hidden)
        unrevealed = {(e.sensor, e.name) for e in calibration.estimates if not e.revealed}
        assert {(sensor.name, "place_z") for sensor in dd_arm.sensors} <= unrevealed
        place = [e for e in calibration.estimates if e.name == "place_z"]
        np.testing.assert_allclose([e.std for e in place], PRIOR.place_m, rtol=0.01)
        np.testing.assert_allclose([e.value for e in place], 0.0, atol=1e-4)


def test_what_hides_together_is_at_least_two(level, upright):
    for calibration in (level, upright):
        for sentence in calibration.hidden:
            if sentence.startswith("these do not show together: "):
                assert " + " in sentence or " - " in sentence, sentence
                assert ": - " not in sentence, sentence  # the others go with or against the first


def test_two_runs_are_better_than_one(dd_arm, level, twice):
    found, told = twice
    ratio = np.array([b.std / a.std for a, b in zip(level.estimates, found.estimates, strict=True)])
    is_revealed = np.array([one.revealed for one in level.estimates])
    assert np.all(ratio < 1.001) and np.all(ratio[is_revealed] < 1.0)
    assert max(abs(off) for off, _ in missed(dd_arm, found).values()) < 4.0
    assert found.passes == len(told) > level.passes


def test_a_second_run_converges_like_the_first(twice):
    """What the first one left of the constants is a prior like any other."""
    assert twice[0].converged


def test_calibrated_sensors_track_better(dd_arm, level, level_run):
    """On the same readings, with the arm as found instead of as filed."""
    true = np.vstack([m.q for m in motions(dd_arm, Bench(RATE_HZ, learning=3, evaluating=0), 0)])[8::16]
    off = [
        np.abs(Smoother(arm, np.zeros(2), True).smooth(level_run).states[:, :6:3] - true).mean()
        for arm in (dd_arm, level.arm)
    ]
    assert off[1] < off[0]


def test_a_sensor_that_rides_on_another_link_than_its_file_says_contradicts_the_rest(dd_arm, level_run, level):
    """Wherever sensors sit on that link: so many instants fit no motion that the arm is not taken for exact."""
    *others, last = dd_arm.sensors
    wrong = replace(dd_arm, sensors=(*others, replace(last, joint=1)))
    found = Smoother(wrong, np.zeros(2), True, PRIOR).smooth(level_run, fine=False)
    assert found.doubted > 0.01 and not found.is_exact
    assert level.doubted < 0.001 and level.discrepancy is None
