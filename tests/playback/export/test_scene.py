"""Pictures of an arm: what is drawn is where the geometry has it."""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from playback.export.camera import Camera, look_at
from playback.export.sampled import Sampled, sample
from playback.export.scene import GRID, GRID_AXIS, PAPER, TWIN_OPACITY, Scene
from tests.playback.export.conftest import source_of

WIDTH, HEIGHT, HEAD = 360, 300, 40


def alone(pair: Sampled) -> Sampled:
    return replace(pair, movers=pair.movers[:1])


def differing(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the centres of the pixels that differ, right and down, (n, 2)."""
    rows, columns = np.nonzero(np.any(one != other, axis=2))
    return np.column_stack([columns, rows]) + 0.5


def camera_of(motion: Sampled) -> Camera:
    return look_at(motion.movers, WIDTH, HEIGHT, HEAD)


@pytest.mark.parametrize("reach_m", [0.06, 0.25, 0.799, 0.8, 1.0, 2.0, 3.99, 4.0, 7.0, 19.9, 20.1])
def test_the_grid_s_lines_are_1_2_or_5_apart(reach_m: float) -> None:
    """The largest such length up to a quarter of the arm's reach; a metre and its tenth count as well."""
    arm = Arm("long", (Joint(a_m=0.6 * reach_m), Joint(a_m=0.4 * reach_m)))
    grid = Scene(sample(source_of(arm), None, 20.0, 1.0).movers, 64, 64).grid_m
    steps = [k * 10.0**power for power in range(-4, 2) for k in (1, 2, 5)]
    assert grid == pytest.approx(max(step for step in steps if step <= 0.25 * reach_m * (1.0 + 1e-9)))


def test_the_grid_is_drawn_where_its_lines_are(pair: Sampled) -> None:
    scene, camera = Scene(pair.movers, WIDTH, HEIGHT, HEAD), camera_of(pair)
    picture = scene.draw(0).astype(int)
    along, across, place = camera.floor
    seen: dict[tuple[int, ...], int] = {}
    for k in range(-8, 9):
        for one, other in ((along, across), (across, along)):
            for shift in (0.25, 0.5, 0.75):
                point = place + k * scene.grid_m * one + (shift + 3.0) * scene.grid_m * other
                x, y = (int(v) for v in camera.project(point)[:2])
                if 1 <= x < WIDTH - 1 and 1 <= y < HEIGHT - 1:
                    near = picture[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3)
                    line = GRID_AXIS if k == 0 else GRID
                    darkest = near[near.sum(axis=1).argmin()]
                    if (darkest >= np.array(GRID_AXIS) - 3).all():  # the arm does not cover it
                        halfway = 0.5 * (np.array(line) + np.array(PAPER))
                        assert np.all(darkest <= halfway + 3.0), (k, shift)
                        seen[line] = seen.get(line, 0) + 1
    assert seen[GRID] >= 10 and seen[GRID_AXIS] >= 2
    between = camera.project(place + (3.5 * along + 3.5 * across) * scene.grid_m)[:2].astype(int)
    assert picture[between[1], between[0]] == pytest.approx(np.array(PAPER), abs=1)


@pytest.mark.parametrize("name", ["dd-arm-vertical", "spatial-arm", "examples/human-arm.toml"])
def test_the_ground_reaches_into_all_corners(name: str) -> None:
    movers = sample(source_of(load_arm(name)), None, 20.0, 1.0).movers
    ground = Scene(movers, 160, 300)._ground
    for corner in itertools.product((slice(40), slice(-40, None)), repeat=2):
        assert np.any(ground[corner] != np.array(PAPER))


def test_lines_through_the_base_lie_over_all_others(pair: Sampled) -> None:
    scene = Scene(pair.movers, WIDTH, HEIGHT, HEAD)
    along, across, place = scene._camera.floor
    for axis, other in ((along, across), (across, along)):
        for k in (-2, 0, 1, 2):
            for share, colour in ((0.0, GRID_AXIS), (0.5, GRID_AXIS if k == 0 else GRID)):
                x, y = scene._camera.project(place + scene.grid_m * (k * other + share * axis))[:2]
                assert scene._ground[int(y), int(x)] == pytest.approx(np.array(colour)), (k, share)


def test_the_tip_s_path_is_pale_and_goes_from_frame_to_frame(
    pair: Sampled, monkeypatch: pytest.MonkeyPatch
) -> None:
    strokes: list[tuple[Any, ...]] = []
    monkeypatch.setattr("playback.export.scene.draw_stroke", lambda *stroke: strokes.append(stroke))
    scene = Scene(pair.movers, WIDTH, HEIGHT, HEAD)
    for frame in (0, 1, 2):
        scene.draw(frame)
    camera = look_at(pair.movers, 2 * WIDTH, 2 * HEIGHT, 2 * HEAD)
    ends = [(first, last) for first, last in ((0, 0), (0, 1), (1, 2)) for _ in pair.movers]
    for (first, last), stroke, mover in zip(ends, strokes, 3 * pair.movers, strict=True):
        places = camera.project(mover.tip)[:, :2]
        start, end, radius, colour, opacity, drawn = stroke
        np.testing.assert_allclose([start, end], [places[first], places[last]])
        assert colour == pytest.approx(0.3 * np.array([250, 250, 252]) + 0.7 * np.array(mover.colours.trace))
        assert (radius, opacity, drawn is scene._ground) == (2.6, 1.0, True)  # of finer pixels


def test_sensors_are_drawn_on_their_links(pair: Sampled) -> None:
    motion = alone(pair)
    (mover,) = motion.movers
    bare = replace(mover, arm=replace(mover.arm, sensors=()))
    camera = camera_of(motion)
    for frame in (0, len(motion.t) - 1):
        changed = differing(Scene((mover,), WIDTH, HEIGHT, HEAD).draw(frame).copy(),
                            Scene((bare,), WIDTH, HEIGHT, HEAD).draw(frame))  # fmt: skip
        places = camera.project(mover.points[frame])[:, :2]
        apart = np.linalg.norm(changed[:, None] - places, axis=2)
        assert np.all(apart.min(axis=1) < 0.08 * camera.scale)
        assert np.all(apart.min(axis=0) < 0.03 * camera.scale)


def test_the_tip_leaves_its_path_behind(pair: Sampled) -> None:
    motion = alone(pair)
    (mover,) = motion.movers
    last, camera = len(motion.t) - 1, camera_of(motion)
    scene, jumped = Scene(motion.movers, WIDTH, HEIGHT, HEAD), Scene(motion.movers, WIDTH, HEIGHT, HEAD)
    for frame in range(last):
        scene.draw(frame)
    trail = differing(scene.draw(last).copy(), jumped.draw(last))
    path = camera.project(mover.tip)[:, :2]
    dense = np.concatenate([np.linspace(a, b, 20) for a, b in zip(path[:-1], path[1:], strict=True)])
    assert np.linalg.norm(trail[:, None] - dense, axis=2).min(axis=1).max() < 3.0
    begun = Scene(motion.movers, WIDTH, HEIGHT, HEAD)
    ahead = differing(begun.draw(0).copy(), scene.draw(0))
    assert len(ahead) > 20  # at the first frame there was no path yet
    assert len(trail) > 20


def test_two_frames_alike_are_one_picture(pair: Sampled) -> None:
    one, other = (Scene(pair.movers, WIDTH, HEIGHT, HEAD).draw(3).copy() for _ in range(2))
    np.testing.assert_array_equal(one, other)


def test_a_twin_is_seen_through(pair: Sampled) -> None:
    """Where it alone is, it has a share of the colour that it would have by itself, and the paper the rest."""
    real, twin = pair.movers
    frame = max(range(len(pair.t)), key=lambda k: float(np.abs(real.q[k] - twin.q[k]).max()))
    both = Scene((real, twin), WIDTH, HEIGHT, HEAD).draw(frame).astype(float)
    solid = Scene((replace(real, colours=twin.colours), twin), WIDTH, HEIGHT, HEAD)
    assert np.any(solid.draw(frame) != both.astype(np.uint8))
    camera = camera_of(pair)
    ends = [camera.project(mover.tip[frame])[:2] for mover in (real, twin)]
    assert np.linalg.norm(ends[0] - ends[1]) > 3.0
    without = Scene((real,), WIDTH, HEIGHT, HEAD)
    assert without._camera.scale == pytest.approx(camera.scale * 2.0, rel=0.05)
    tinted = (both[..., 0] - both[..., 2] > 20.0) & (both[..., 0] > 180.0)  # reddish and pale
    assert tinted.sum() > 30
    far = np.array([206.0, 128.0, 92.0])
    shade = both[tinted] - (1.0 - TWIN_OPACITY) * np.array(PAPER)
    hue = shade / np.linalg.norm(shade, axis=1, keepdims=True) @ (far / np.linalg.norm(far))
    assert np.median(hue) > 0.98


def test_the_two_stand_on_one_base(pair: Sampled) -> None:
    real, twin = pair.movers
    here = Scene((real, twin), WIDTH, HEIGHT, HEAD).draw(0).copy()
    pale = replace(twin, colours=twin.colours._replace(base=(255, 0, 255)))
    np.testing.assert_array_equal(here, Scene((real, pale), WIDTH, HEIGHT, HEAD).draw(0))
    loud = replace(real, colours=real.colours._replace(base=(255, 0, 255)))
    base = differing(here, Scene((loud, twin), WIDTH, HEIGHT, HEAD).draw(0))
    centre = camera_of(pair).project(np.zeros(3))[:2]
    assert len(base) > 20 and np.linalg.norm(base - centre, axis=1).max() < 0.3 * HEIGHT
