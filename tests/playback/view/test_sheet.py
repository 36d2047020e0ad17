"""The numbers beside the arm, in degrees and millimetres."""

from dataclasses import replace

import numpy as np

from arm.model import Arm, Joint
from playback.view.feed import Picture, Pose, Row
from playback.view.sheet import heading, numbers, table

ARM = Arm("crane", (Joint(a_m=0.3), Joint("prismatic", d_m=0.1)))
REAL = Pose(np.array([0.5, 0.25]), np.array([0.1, -0.2, 0.3]))
OTHER = Pose(np.array([0.51, 0.5]), np.array([0.1, -0.197, 0.304]))


def picture(twin: Pose | None) -> Picture:
    return Picture(1, 0, 0.0, Row(0.0, REAL, twin), "limb/play", "file", 1.0, {})


def test_joints_and_tip() -> None:
    assert numbers(ARM, picture(None), None) == [
        ("q1", "28.65°"),
        ("q2", "250.00 mm"),
        ("tip", "100.0, -200.0, 300.0 mm"),
    ]


def test_a_twin_is_as_far_off_as_its_worst_joint() -> None:
    lines = dict(numbers(ARM, picture(OTHER), None))
    assert lines["error of angle"] == "250.00 mm (q2)"
    assert lines["error of tip"] == "5.00 mm"  # 3 and 4 mm
    nearer = replace(OTHER, q=np.array([0.51, 0.2501]))
    assert dict(numbers(ARM, picture(nearer), None))["error of angle"] == "0.57° (q1)"


def test_a_twin_of_other_joints_has_no_error() -> None:
    assert "error of angle" not in dict(numbers(ARM, picture(replace(OTHER, q=np.zeros(3))), None))


def test_lateness_is_said_where_it_is_known() -> None:
    known = numbers(ARM, picture(None), {"lateness_ms": {"p50": 0.125, "p99": 1.5}})
    assert known[-1] == ("lateness p50 / p99", "0.12 / 1.50 ms")
    for state in ({}, {"lateness_ms": None}, {"lateness_ms": {"p50": None, "p99": None}}):
        assert numbers(ARM, picture(None), state) == known[:-1]


def test_what_is_named_is_escaped() -> None:
    said = heading(replace(ARM, name="<b>"), replace(ARM, name="x&y"), "a<i>", "<live>", "#123456")
    assert (
        "&lt;b&gt;" in said and "and its twin x&amp;y" in said and "a&lt;i&gt;" in said and "&lt;live&gt;" in said
    )
    assert "<i>" not in said and "<live>" not in said and "#123456" in said
    assert "<td" in table([("<q>", "1 & 2")]) and "&lt;q&gt;" in table([("<q>", "")])
    assert table([("one", "1"), ("two", "2")]).count("<tr>") == 2


def test_a_twin_of_the_same_name_is_not_named_again() -> None:
    assert "and its twin<" in heading(ARM, ARM, "", "", "")
    assert "twin" not in heading(ARM, None, "", "", "")
