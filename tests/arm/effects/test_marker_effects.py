"""Effects on markers: where they are in which trial, and what an arm file may say of them."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.effects.marker_effects import marked_in, slid_markers
from arm.model import Effect, Marker
from limbcal.errors import ConfigError

MOVED = Effect("marker_moved", {"x_m": 0.01, "y_m": 0.0, "z_m": -0.02, "trials": [2, 3]}, markers=("A",))
SWAPPED = Effect("label_swap", {}, markers=("A", "B"))
SLID = Effect(
    "soft_tissue",
    {"x_m_rad": 0.01, "y_m_rad": 0.02, "z_m_rad": 0.0, "rest_rad": 0.5, "joint": 2},
    markers=("B",),
)


@pytest.fixture
def arm():
    markers = (Marker("A", 1, (0.1, 0.0, 0.0), 0.004), Marker("B", 2, (0.2, 0.0, 0.0)))
    return replace(load_arm("dd-arm"), markers=markers)


def place(arm, name):
    return next(marker for marker in arm.markers if marker.name == name)


def test_an_arm_file_keeps_them(arm):
    having = replace(arm, effects=(MOVED, SWAPPED, SLID))
    again = parse_arm(format_arm(having), "it")
    assert again.effects[1:] == (SWAPPED, SLID)
    assert dict(again.effects[0].parameters) == dict(MOVED.parameters)


def test_a_marker_is_moved_in_the_trials_that_are_listed(arm):
    having = replace(arm, effects=(MOVED,))
    assert marked_in(having, 1) == arm
    np.testing.assert_allclose(place(marked_in(having, 3), "A").position_m, [0.11, 0.0, -0.02])


def test_exchanged_names_stay_at_their_places(arm):
    swapped = marked_in(replace(arm, effects=(SWAPPED,)), 1)
    assert (place(swapped, "A").joint, place(swapped, "B").joint) == (2, 1)
    assert place(swapped, "B").position_m == place(arm, "A").position_m


def test_skin_slides_from_rest_in_proportion_to_the_joint(arm):
    q = np.array([[9.0, 0.5], [9.0, 1.5], [9.0, -0.5]])
    slid = slid_markers(replace(arm, effects=(SLID,)), q)
    assert set(slid) == {"B"}
    np.testing.assert_allclose(slid["B"], [[0.0, 0.0, 0.0], [0.01, 0.02, 0.0], [-0.01, -0.02, 0.0]])


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (replace(SWAPPED, markers=("A",)), "acts on 2 markers at once"),
        (replace(MOVED, markers=("C",)), "expected one of A, B"),
        (replace(MOVED, markers=(), joints=(1,)), "markers is missing"),
    ],
)
def test_what_an_effect_cannot_act_on_is_said(arm, effect, said):
    with pytest.raises(ConfigError, match=said):
        marked_in(replace(arm, effects=(effect,)), 1)
