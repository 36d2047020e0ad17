"""Forces that cannot be right are questioned."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Body
from arm.moving_base import standing_base
from fitter.ground.force_plausibility import far, light, pulling, unknown
from protocol.markers.wrench_files import PlateWrench

LEG = replace(
    load_arm("human-leg-right"), gravity_m_s2=(0.0, -9.80665, 0.0), body=Body("human-leg-right", 60.0, 1.7, "f")
)
T = np.arange(100) * 0.01


def upwards(newtons: float) -> np.ndarray:
    return np.tile([0.0, newtons, 0.0], (len(T), 1))


def test_where_a_force_is_not_known_is_said():
    force = upwards(300.0)
    assert unknown("left", T, force) == []
    force[40:50] = np.nan
    (note,) = unknown("left", T, force)
    assert (note.kind, note.columns, note.from_s, note.to_s) == ("nan_forces", ("left",), 0.4, 0.49)


def test_the_ground_does_not_pull():
    assert pulling(LEG, "left", upwards(300.0)) == pulling(LEG, "left", upwards(-5.0)) == []
    (note,) = pulling(LEG, "left", upwards(-300.0))
    assert note.kind == "sign" and "300 N" in note.text
    assert pulling(load_arm("dd-arm"), "left", upwards(-300.0)) == []  # a robot may hang on it


@pytest.mark.parametrize(("newtons", "noted"), [(300.0, 0), (60.0, 1)])
def test_plates_carry_who_stands_on_them(newtons, noted):
    plates = [PlateWrench("a", T, upwards(newtons), upwards(0.0), upwards(0.0))]
    notes = light(LEG, plates)
    assert [note.kind for note in notes] == ["unit"] * noted
    assert light(replace(LEG, body=None), plates) == []


def test_a_force_far_from_its_link_is_said():
    q, base = np.zeros((len(T), LEG.n_joint)), standing_base(len(T))
    assert [note.kind for note in far(LEG, q, base, "a", 6, upwards(300.0), upwards(9.0))] == ["contact_far"]
    assert far(LEG, q, base, "a", 6, upwards(0.0), upwards(9.0)) == []
