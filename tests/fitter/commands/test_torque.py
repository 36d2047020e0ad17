"""`fitter torque`: which link a plate's force acts on, what stands in a motion, and where the base stands."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.body.whole_body import body_map
from arm.model import Arm, Base, Joint, Link
from fitter.commands.torque import contacts_of
from fitter.data.motion_file import write_motion
from limbcal.errors import ConfigError
from protocol.markers.wrench_files import PlateWrench


def plate(name: str, force_N: float = 400.0) -> PlateWrench:
    zero = np.zeros((2, 3))
    return PlateWrench(name, np.array([0.0, 1.0]), zero + [0.0, force_N, 0.0], zero, zero)


def test_a_whole_persons_feet_are_links_by_their_names():
    left, right = plate("left"), plate("right")
    found = contacts_of(["1=foot_left", "right=foot_right"], [left, right], load_arm("human-body"))
    assert [one for one, _ in found] == [left, right]
    assert [joint for _, joint in found] == [
        1 + body_map().parts[name].link for name in ("foot_left", "foot_right")
    ]


def test_of_a_robot_links_are_numbers():
    assert contacts_of(["1=2"], [plate("table")], load_arm("dd-arm"))[0][1] == 2
    assert contacts_of([], [plate("table"), plate("empty", 0.0)], load_arm("dd-arm"))[0][1] == 2


@pytest.mark.parametrize("text", ["1=3", "1=0", "1=foot_left", "1", "7=1"])
def test_a_link_or_plate_that_is_not_there_is_said(text):
    with pytest.raises(ConfigError, match="--contact"):
        contacts_of([text], [plate("table")], load_arm("dd-arm"))


def test_two_loaded_plates_need_a_word():
    with pytest.raises(ConfigError, match="such as --contact a=hand"):
        contacts_of([], [plate("a"), plate("b")], load_arm("human-arm-left"))


#: 2 kg at 0.2 m: 3.92 N m where it lies across gravity.
ONE = Arm("one", (Joint(a_m=0.4, link=Link(2.0, (0.2, 0.0, 0.0), (0.01, 0.1, 0.1, 0.0, 0.0, 0.0))),))
ONE = replace(ONE, gravity_m_s2=(0.0, -9.80665, 0.0))
HOLDING = 2.0 * 0.2 * 9.80665


@pytest.mark.parametrize(
    ("base", "expected"),
    [
        (None, HOLDING - 80.0),
        (Base((0.5, 0.0, 0.0)), HOLDING - 30.0),
        (Base(rotation_rad=(0.0, 0.0, np.pi / 2)), HOLDING - 80.0),  # gravity goes with frame 0
        (Base(rotation_rad=(0.0, 0.0, np.pi / 2), segment="thorax"), -80.0),  # gravity is in the world
    ],
)
def test_a_base_stands_where_the_file_has_it(fitter, tmp_path, base, expected):
    """Upwards 100 N at 0.8 m along x of the world."""
    t = 0.01 * np.arange(50)
    save_arm(replace(ONE, base=base), tmp_path / "arm.toml")
    write_motion(tmp_path / "m.csv", {"t": t, "q": np.zeros((50, 1))})
    names = [f"ground_{part}{axis}" for part in ("force_v", "force_p", "torque_") for axis in "xyz"]
    rows = np.column_stack([t, np.tile([0.0, 100.0, 0.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0], (50, 1))])
    head = f"f\nversion=1\nnRows=50\nnColumns=10\ninDegrees=no\nendheader\n{chr(9).join(['time', *names])}"
    np.savetxt(tmp_path / "f.mot", rows, delimiter="\t", header=head, comments="")
    out = tmp_path / "out.npz"
    options = ("--arm", tmp_path / "arm.toml", "--ground", tmp_path / "f.mot", "--out", out)
    assert fitter("torque", tmp_path / "m.csv", *options).code == 0
    np.testing.assert_allclose(np.load(out)["tau1"], expected, rtol=1e-9)


def needed(fitter, tmp_path, kept=slice(None), **columns):
    """Return what `fitter torque` says, writes and should write, of a joint that swings."""
    t = 0.005 * np.arange(600)
    angle = 3.0 + 0.5 * np.sin(4.0 * t)
    table = {"t": t, "q": angle[:, None], **{name: made(angle, t)[:, None] for name, made in columns.items()}}
    save_arm(ONE, tmp_path / "arm.toml")
    write_motion(tmp_path / "m.csv", {name: values[kept] for name, values in table.items()})
    outcome = fitter("torque", tmp_path / "m.csv", "--arm", tmp_path / "arm.toml", "--out", tmp_path / "out.npz")
    ddq = -8.0 * np.sin(4.0 * t)
    tau = 0.1 * ddq + HOLDING * np.cos(angle)
    return outcome, dict(np.load(tmp_path / "out.npz")) if outcome.code == 0 else {}, tau[kept]


def wrapped(angle, _t):
    return np.angle(np.exp(1j * angle))


def backwards(_angle, t):
    return -2.0 * np.cos(4.0 * t)


@pytest.mark.parametrize(
    ("kept", "columns", "kind"),
    [
        (slice(None), {"q": wrapped}, "turn"),
        (slice(None), {"dq": backwards}, "sign"),
        (np.r_[:200, 340:600], {}, "gap"),
    ],
)
def test_what_contradicts_itself_is_put_right_and_noted(fitter, tmp_path, kept, columns, kind):
    outcome, found, expected = needed(fitter, tmp_path, kept, **columns)
    assert outcome.code == 0 and kind in {note["kind"] for note in outcome.document["notes"]}
    np.testing.assert_allclose(found["tau1"], expected, rtol=0, atol=0.02)


def test_velocities_in_degrees_are_refused(fitter, tmp_path):
    outcome, *_ = needed(fitter, tmp_path, dq=lambda _, t: np.rad2deg(2.0 * np.cos(4.0 * t)))
    assert outcome.code != 0 and "is dq in degrees" in outcome.said


def test_a_sliding_joint_is_driven_by_newtons(fitter, tmp_path):
    lift = Arm("lift", (Joint("prismatic", link=ONE.joints[0].link), ONE.joints[0]))
    save_arm(lift, tmp_path / "lift.toml")
    write_motion(tmp_path / "m.csv", {"t": 0.01 * np.arange(50), "q": np.zeros((50, 2))})
    options = ("--arm", tmp_path / "lift.toml", "--out", tmp_path / "o.csv")
    assert "39.2 N, 0 N m" in fitter("torque", tmp_path / "m.csv", *options).said
