"""Sums in files, and added."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.model import Control
from arm.structural_parameters import structural_parameters
from fitter.data.motion_file import write_motion
from fitter.regression_sums.saved_sums import ArmSums, add_sums, equation_of, is_sums, load_sums, save_sums
from fitter.regression_sums.torque_sums import torque_sums
from limbcal.errors import ConfigError, DataError

ARM = load_arm("dd-arm")
BASE = structural_parameters(ARM)


def sums_of(seed, n=300, arm=ARM):
    motion = np.random.default_rng(seed).normal(size=(4, n, arm.n_joint))
    base = structural_parameters(arm)
    return ArmSums(equation_of(arm, 0.02), torque_sums(arm, base, *motion, rest_speed=0.02), (f"trial {seed}",))


def same(a, b):
    arrays = ("gram", "moment", "power", "row", "torque", "count", "trial")
    return (
        all(np.array_equal(getattr(a.sums, name), getattr(b.sums, name)) for name in arrays)
        and a.sums.samples == b.sums.samples
        and (a.trials, a.equation) == (b.trials, b.equation)
    )


def test_what_is_read_is_what_was_saved(tmp_path):
    saved = add_sums([sums_of(0), sums_of(1)], ["a", "b"])
    save_sums(tmp_path / "s.npz", saved)
    assert same(load_sums(tmp_path / "s.npz"), saved)
    save_sums(tmp_path / "again.npz", load_sums(tmp_path / "s.npz"))
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "s.npz").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["again.npz", "s.npz"]


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(1, 400), min_size=3, max_size=3))
def test_adding_is_associative_to_the_last_bit(lengths):
    a, b, c = (sums_of(k, n) for k, n in enumerate(lengths))
    left = add_sums([add_sums([a, b], ["", ""]), c], ["", ""])
    right = add_sums([a, add_sums([b, c], ["", ""])], ["", ""])
    assert same(left, right)
    assert same(left, add_sums([a, b, c], ["", "", ""]))
    assert left.trials == ("trial 0", "trial 1", "trial 2")
    assert np.unique(left.sums.trial).tolist() == [0, 1, 2]


longer = replace(ARM, joints=(replace(ARM.joints[0], a_m=0.26), ARM.joints[1]))


@pytest.mark.parametrize(
    ("arm", "said"),
    [
        (longer, "geometry is 0.0, 0.26"),
        (load_arm("dd-arm-vertical"), "gravity_m_s2 is"),
        (replace(ARM, control=Control()), "law is measured, expected pd"),
        (replace(ARM, control=replace(ARM.control, kp=(9.5, 8.0))), "gains is 9.5, 8.0"),
    ],
)
def test_sums_of_another_arm_or_law_refuse(arm, said):
    with pytest.raises(ConfigError, match="b.npz: these sums are of another arm or law") as caught:
        add_sums([sums_of(0), sums_of(1, arm=arm)], ["a.npz", "b.npz"])
    assert said in str(caught.value)


def test_a_trial_in_two_parts_is_refused():
    part, both = sums_of(1), add_sums([sums_of(0), sums_of(1)], ["a.npz", "b.npz"])
    with pytest.raises(ConfigError, match="c.npz: trial 'renamed' is in both.npz too"):
        add_sums([both, replace(part, trials=("renamed",))], ["both.npz", "c.npz"])


def test_masses_and_friction_of_the_arm_do_not_matter():
    heavy = replace(ARM, joints=tuple(replace(j, link=replace(j.link, mass_kg=9.0)) for j in ARM.joints))
    assert equation_of(heavy, 0.02) == equation_of(ARM, 0.02)


def test_what_holds_sums_is_told_from_what_holds_motion(tmp_path):
    save_sums(tmp_path / "s.npz", sums_of(0))
    write_motion(tmp_path / "m.npz", {"t": np.arange(3.0), "q": np.zeros((3, 2))})
    (tmp_path / "x.npz").write_bytes(b"PK nonsense")
    found = [is_sums(tmp_path / name) for name in ("s.npz", "m.npz", "x.npz", "none.npz")]
    assert found == [True, False, False, False]
    with pytest.raises(DataError, match=r"m.npz: cannot be read as sums"):
        load_sums(tmp_path / "m.npz")


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_damaged_file_is_said_or_read_as_it_was(tmp_path, data):
    good = sums_of(0, n=3)
    save_sums(tmp_path / "s.npz", good)
    whole = bytearray((tmp_path / "s.npz").read_bytes())
    if data.draw(st.booleans()):
        whole = whole[: data.draw(st.integers(0, len(whole) - 1))]
    else:
        whole[data.draw(st.integers(0, len(whole) - 1))] ^= data.draw(st.integers(1, 255))
    (tmp_path / "bad.npz").write_bytes(whole)
    try:
        assert same(load_sums(tmp_path / "bad.npz"), good)
    except DataError as error:
        assert "bad.npz: " in str(error)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"sums_schema": np.asarray(2)}, "schema 2, expected 1"),
        ({"moment": np.zeros((3, 2, 7))}, "moment has shape (3, 2, 7), expected (3, 2, 8)"),
        ({"power": np.full((3, 2), np.nan)}, "power holds values that are not finite"),
        ({"trial": np.array([0, 2, 2])}, "not of trials 1 to 1"),
        ({"gram": np.array([object()], dtype=object)}, "cannot be read as sums"),
        ({"gram": np.array(["x"])}, "gram"),
    ],
)
def test_arrays_that_do_not_fit_are_said(tmp_path, change, said):
    save_sums(tmp_path / "s.npz", sums_of(0, n=3))
    with np.load(tmp_path / "s.npz") as file:
        arrays = dict(file)
    np.savez(tmp_path / "bad.npz", **(arrays | change))
    with pytest.raises(DataError) as caught:
        load_sums(tmp_path / "bad.npz")
    assert said in str(caught.value)


def test_only_npz_is_written(tmp_path):
    with pytest.raises(ConfigError, match="expected .npz"):
        save_sums(tmp_path / "s.csv", sums_of(0))
