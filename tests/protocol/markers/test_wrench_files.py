"""Forces of a MOT file against those that were written into it."""

import numpy as np
import pytest

from limbcal.errors import ConfigError, DataError
from protocol.markers.wrench_files import EMPTY_N, PlateWrench, read_wrenches

COLUMNS = [f"ground_force_{k}_{kind}{axis}" for k in (1, 2) for kind in "vp" for axis in "xyz"]
COLUMNS += [f"ground_moment_{k}_m{axis}" for k in (1, 2) for axis in "xyz"]


@pytest.fixture
def written(tmp_path):
    numbers = np.random.default_rng(0).normal(size=(20, 18))
    numbers[:, 7] += 700.0
    t = np.arange(20) * 0.01
    rows = ["\t".join(f"{x:.9g}" for x in row) for row in np.column_stack([t, numbers])]
    path = tmp_path / "forces.mot"
    path.write_text("\n".join(["forces", "nRows=20", "endheader", "\t".join(["time", *COLUMNS]), *rows]), "utf-8")
    return path, t, numbers


def test_every_plate_has_its_force_point_and_moment(written):
    path, t, numbers = written
    first, second = read_wrenches(path)
    for plate, at in ((first, 0), (second, 6)):
        np.testing.assert_allclose(plate.t, t)
        np.testing.assert_allclose(plate.force, numbers[:, at : at + 3], rtol=1e-8)
        np.testing.assert_allclose(plate.point_m, numbers[:, at + 3 : at + 6], rtol=1e-8)
        np.testing.assert_allclose(plate.moment, numbers[:, 12 + at // 2 : 15 + at // 2], rtol=1e-8)
    assert second.is_loaded and not first.is_loaded


def test_between_samples_it_is_interpolated_and_outside_it_is_not_known():
    t, ones = np.array([0.0, 1.0]), np.ones((2, 3))
    plate = PlateWrench("one", t, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 4.0 * EMPTY_N]]), ones, ones)
    force, point, moment = plate.at(np.array([-1.0, 0.25, 2.0]))
    np.testing.assert_allclose(force[:, 2], [np.nan, EMPTY_N, np.nan])
    np.testing.assert_allclose((point[1], moment[1]), 1.0)


def test_a_force_without_a_point_is_not_known_and_an_empty_plate_needs_none():
    t, up = np.arange(5.0), np.array([0.0, 0.0, 4.0 * EMPTY_N])
    force, point = np.array([0.0, 1.0, 1.0, 1.0, np.nan])[:, None] * up, np.full((5, 3), np.nan)
    point[1:3] = [0.2, 0.1, 0.0]
    plate = PlateWrench("one", t, force, point, np.zeros((5, 3)))
    force, point, moment = plate.at(np.array([0.0, 0.5, 1.5, 2.5, 3.5]))
    np.testing.assert_allclose(force[:, 2], [0.0, 2.0 * EMPTY_N, 4.0 * EMPTY_N, np.nan, np.nan])
    about = np.cross(point, force) + moment
    np.testing.assert_allclose(about[:3, 0], [0.0, 0.2 * EMPTY_N, 0.4 * EMPTY_N], atol=1e-12)


def test_decimal_commas_and_a_byte_order_mark_are_read(written):
    path, _, _ = written
    text = path.read_text("utf-8")
    (first, _), named = read_wrenches(path), path.with_name("other.mot")
    named.write_text(text.replace(".", ","), "utf-16")
    (again, _) = read_wrenches(named)
    np.testing.assert_array_equal(again.force, first.force)


def test_what_is_no_file_of_forces_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="expected .mot, .sto or .c3d"):
        read_wrenches(tmp_path / "forces.csv")
    path = tmp_path / "forces.sto"
    for text, wrong in (
        ("time x", "endheader"),
        ("endheader\nx y\n1 2", "expected 'time'"),
        ("endheader\ntime a_vx a_vy a_vz\n0 1 1 1\n0 1 1 1", "row 2 is at 0 s and the one before it at 0 s"),
        ("endheader\ntime q\n0 1\n1 1", "no forces"),
        ("endheader\ntime a_vx a_vy a_vz\n0 1 1 1\n1 1 x 1", "row 2: .*'x', expected numbers"),
        ("endheader\ntime a_vx a_vy a_vz\n0 1 1 1", "1 samples, expected at least two"),
    ):
        path.write_text(text, "utf-8")
        with pytest.raises(DataError, match=wrong):
            read_wrenches(path)


def test_a_table_without_points_has_its_moments_about_the_origin(tmp_path):
    names = ["time", *(f"ground_force_v{axis}" for axis in "xyz"), *(f"ground_torque_{axis}" for axis in "xyz")]
    rows = [" ".join(f"{x}" for x in (0.01 * k, 1.0, 2.0, 700.0, 4.0, 5.0, 6.0)) for k in range(5)]
    path = tmp_path / "forces.mot"
    path.write_text("\n".join(["forces", "endheader", " ".join(names), *rows]), "utf-8")
    (plate,) = read_wrenches(path)
    np.testing.assert_allclose(plate.force[0], [1.0, 2.0, 700.0])
    np.testing.assert_allclose(plate.point_m, 0.0)
    np.testing.assert_allclose(plate.moment[0], [4.0, 5.0, 6.0])


def test_of_a_free_moment_one_axis_is_enough_beside_a_point(tmp_path):
    names = ["time", *(f"ground_force_{kind}{axis}" for kind in "vp" for axis in "xyz"), "ground_torque_y"]
    rows = [" ".join(f"{x}" for x in (0.01 * k, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)) for k in range(5)]
    path = tmp_path / "forces.mot"
    path.write_text("\n".join(["forces", "endheader", " ".join(names), *rows]), "utf-8")
    (plate,) = read_wrenches(path)
    np.testing.assert_allclose((plate.point_m[0], plate.moment[0]), [[4.0, 5.0, 6.0], [0.0, 7.0, 0.0]])
