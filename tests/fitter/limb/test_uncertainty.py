"""Lengths, centres and axes of a limb in hand-worked numbers; errors where they have a closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.body.landmarks import limb_map
from arm.body.limbs import MEAN_PERSON, limb
from arm.kinematics import axis_frames
from fitter.functional.disjoint import jackknife
from fitter.limb.bundle import Bundle
from fitter.limb.free_geometry import geometry_of
from fitter.limb.functional_error import systematic_std_m
from fitter.limb.uncertainty import LEARNT, Derived, Errors, derived, errors, errors_of, towards
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task()


def of_preset(preset, girdle="scapula"):
    arm = limb(replace(MEAN_PERSON, preset=preset), girdle)
    where = limb_map(preset, arm.n_joint)
    links = np.repeat([part.link for part in where.parts.values()], 3)
    place = np.random.default_rng(0).normal(size=(len(links), 3))
    return arm, where, derived(where, geometry_of(arm), links, place, place), links, place


@pytest.mark.parametrize("preset", ["human-arm-right", "human-arm-left", "human-leg-right", "human-leg-left"])
def test_lengths_and_axes_are_those_of_the_kinematics(preset):
    arm, where, found, _, _ = of_preset(preset)
    frames = axis_frames(arm, np.zeros(arm.n_joint))[0]
    side, joints = where.side, ("elbow", "wrist") if "arm" in preset else ("knee", "ankle")
    ends = {}
    for name in joints:
        segment, x = found.centres[f"{name}_{side}"]
        T = frames[where.parts[segment].link]
        ends[name] = T[:3, :3] @ x + T[:3, 3]
    first, second = found.lengths.values()
    assert np.linalg.norm(ends[joints[0]]) == pytest.approx(first)
    assert np.linalg.norm(ends[joints[1]] - ends[joints[0]]) == pytest.approx(second)
    for name, (segment, way) in found.axes.items():
        link = where.parts[segment].link
        np.testing.assert_allclose(frames[link, :3, :3] @ way, frames[link + 1, :3, 2], atol=1e-12)
        assert where.axes[name.removesuffix(f"_{side}")] == link + 1


def test_a_girdle_is_as_long_as_the_way_to_the_shoulder():
    arm, where, found, *_ = of_preset("human-arm-right", "thorax")
    frames = axis_frames(arm, np.zeros(arm.n_joint))[0]
    shoulder = frames[where.balls[0], :3, 3]
    assert found.lengths["girdle"] == pytest.approx(np.linalg.norm(shoulder))
    assert next(iter(found.centres)).startswith("girdle")


def test_centres_move_with_the_markers_frame():
    arm, where, found, links, place = of_preset("human-leg-right")
    turn, shift = Rotation.from_rotvec([0.2, -0.3, 0.1]).as_matrix(), np.array([0.1, 0.0, -0.2])
    other = derived(where, geometry_of(arm), links, place, place @ turn.T + shift)
    for name, (_, x) in list(found.centres.items())[1:]:
        np.testing.assert_allclose(other.centres[name][1], turn @ x + shift, atol=1e-12)
    np.testing.assert_allclose(other.axes["knee_right"][1], turn @ found.axes["knee_right"][1], atol=1e-12)
    assert len(found.vector()) == 2 + 3 * (len(found.centres) + len(found.axes))
    np.testing.assert_array_equal(found.vector()[2:5], found.centres["hip_right"][1])


@pytest.mark.parametrize("n", [3, 6])
def test_a_rigid_motion_is_found_again(n):
    place = np.random.default_rng(1).normal(size=(n, 3))
    turn, shift = Rotation.from_rotvec([2.0, -0.3, 1.0]).as_matrix(), np.array([0.1, 0.5, -0.2])
    R, s = towards(place, place @ turn.T + shift)
    np.testing.assert_allclose(R, turn, atol=1e-12)
    np.testing.assert_allclose(s, shift, atol=1e-12)


def test_few_markers_shift_and_none_stay():
    place = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    R, s = towards(place, place @ Rotation.from_rotvec([0, 0, 0.5]).as_matrix().T + 1.0)
    np.testing.assert_array_equal(R, np.eye(3))
    assert s == pytest.approx([1.0 + 0.5 * (np.cos(0.5) - 1.0), 1.0 + 0.5 * np.sin(0.5), 1.0])
    assert towards(place[:0], place[:0])[1].tolist() == [0.0, 0.0, 0.0]


def linear(known, S, b, n_part):
    """Return a bundle whose derived numbers are its shared ones times two."""
    bundle = Bundle(known.task.prior.geometry, known.markers, known.q, S, b, True, 1)
    task = replace(known.task, prior=replace(known.task.prior, place=known.markers.place))

    def derive(geometry, place):
        return Derived({"d3": 2.0 * geometry.numbers[2, 2]}, {}, {})

    return task, bundle, derive


def test_without_scatter_between_parts_the_error_is_the_posteriors(known):
    n = len(known.task.prior.information)
    S = np.tile(3.0 * np.diag(known.task.prior.information), (2, 1, 1))
    task, bundle, derive = linear(known, S, np.zeros((2, n)), 2)
    found = errors_of(task, bundle, 2, [bundle, bundle], derive)
    np.testing.assert_allclose(found.free_std, task.free.std / np.sqrt(7.0), rtol=1e-9)
    assert found.learnt.all() and found.n_part == 2 and len(found.apart) == 2
    k = task.free.names.index("d3")
    assert np.sqrt(found.derived_covariance[0, 0]) == pytest.approx(2.0 * task.free.std[k] / np.sqrt(7.0))
    weak = errors_of(*linear(known, 0.1 * S, np.zeros((2, n)), 2)[:2], 2, [], derive)
    assert not weak.learnt.any() and 1.0 / np.sqrt(1.6) > LEARNT


def test_scatter_between_parts_is_the_jackknifes(known):
    n, n_part = len(known.task.prior.information), 4
    information = known.task.prior.information
    S = np.tile(50.0 * np.diag(information), (n_part, 1, 1))
    b = np.random.default_rng(0).normal(size=(n_part, n)) * 50.0 * np.sqrt(information)
    task, bundle, derive = linear(known, S, b, n_part)
    found = errors_of(task, bundle, n_part, [], derive)
    k = task.free.names.index("d3")

    def step(use):
        return np.array([4.0 / use.sum() * b[use, k].sum() / (201.0 * information[k])])

    expected = np.sqrt(jackknife(step, n_part)[0, 0])
    assert found.free_std[k] == pytest.approx(expected, rel=1e-6)
    assert np.sqrt(found.derived_covariance[0, 0]) == pytest.approx(2.0 * expected, rel=1e-6)


def test_what_hips_are_off_by_alike_comes_on_top(known):
    n = len(known.task.prior.information)
    S = np.tile(3.0 * np.diag(known.task.prior.information), (2, 1, 1))
    task, bundle, _ = linear(known, S, np.zeros((2, n)), 2)
    where = limb_map("human-leg-right", 6)
    found = errors(where, task, bundle, 2, [])
    off, own = systematic_std_m("hip"), task.free.std / np.sqrt(7.0)
    more = {"base_x", "base_y", "base_z", "d3"}
    expected = [np.hypot(s, off) if name in more else s for name, s in zip(task.free.names, own, strict=True)]
    assert off > 0.0
    np.testing.assert_allclose(found.free_std, expected, rtol=1e-9)
    d3 = expected[task.free.names.index("d3")]
    assert np.sqrt(found.derived_covariance[0, 0]) == pytest.approx(d3)  # the thigh
    assert np.sqrt(found.derived_covariance[2, 2]) == pytest.approx(expected[task.free.names.index("base_x")])


def test_halves_are_apart_by_their_distance():
    one, other = (Derived({}, {"hip": ("pelvis", np.array(x))}, {}) for x in ([0.0, 0.0, 0.0], [0.0, 0.03, 0.04]))
    found = Errors(np.zeros(1), np.ones(1, dtype=bool), np.zeros((3, 3)), (one, other), 2)
    assert found.apart_m("centres", "hip") == pytest.approx(0.05)


def test_an_error_is_no_less_than_disjoint_fits_disagree_by(known):
    n = len(known.task.prior.information)
    S = np.tile(50.0 * np.diag(known.task.prior.information), (2, 1, 1))
    task, bundle, _ = linear(known, S, np.zeros((2, n)), 2)
    moved = replace(bundle, markers=replace(bundle.markers, place=bundle.markers.place + [0.0, 0.0, 0.2]))

    def derive(geometry, place):
        return Derived({}, {"c": ("s", place[0])}, {})

    alone = errors_of(task, bundle, 2, [], derive).derived_covariance
    found = errors_of(task, bundle, 2, [bundle, moved], derive)
    assert found.derived_covariance[2, 2] == pytest.approx(max(alone[2, 2], 0.1**2))
    assert found.apart_m("centres", "c") == pytest.approx(0.2)
