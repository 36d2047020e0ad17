"""Angles in degrees are asked about."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.motions import Measured
from fitter.data.plausibility.angle_unit import look
from fitter.data.plausibility.refusal import Refusal
from tests.fitter.data.plausibility.conftest import changed


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("without", [(), ("tau",), ("tip",), ("tau", "tip")])
def test_degrees_are_named_by_torque_tip_or_magnitude(arm, clean, seed, without):
    motion = clean(seed)
    columns = {role: values for role, values in motion.columns.items() if role not in without}
    assert look(replace(motion, columns=columns), arm).columns is columns
    with pytest.raises(Refusal, match=r"joint \d moves .* to and fro .*degrees\?.*q=q\{j\}:deg"):
        look(replace(motion, columns={**columns, "q": np.rad2deg(columns["q"])}), arm)


def test_the_torque_tells_small_motions_in_degrees(arm, clean):
    motion = clean(2, 0.1)
    with pytest.raises(Refusal, match="degrees"):
        look(changed(motion, q=np.rad2deg(motion.columns["q"])), arm)


@pytest.mark.parametrize(
    ("column", "words"), [("q", "is q in degrees, dq not"), ("dq", "is dq in degrees, q not")]
)
def test_a_velocity_of_another_unit_is_named(arm, clean, column, words):
    motion = clean(1)
    dq = np.gradient(motion.columns["q"], motion.t, axis=0)
    given = changed(motion, dq=dq)
    with pytest.raises(Refusal, match=words):
        look(changed(given, **{column: np.rad2deg(given.columns[column])}), arm)


def test_a_unit_that_is_stated_is_believed(arm, clean):
    motion = clean()
    stated = replace(motion, stated=frozenset({"q1", "q2"}), columns={"q": np.rad2deg(motion.columns["q"])})
    assert look(stated, arm) is stated


def test_a_wheel_to_and_fro_at_a_wheel_s_speed_is_none():
    t = np.arange(0.0, 60.0, 0.01)
    motion = Measured("w", "w", 0, t, {"q": np.column_stack([37.0 * np.sin(0.2 * t), np.sin(t)])})
    assert look(motion, load_arm("dd-arm")) is motion
