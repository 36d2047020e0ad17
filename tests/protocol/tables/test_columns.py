"""Mappings of foreign columns, and every mistake in one."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import ConfigError
from protocol.tables.columns import JOINT_ROLES, parse_mapping


def text(address):
    return None if address is None else address.text


def test_without_a_mapping_every_column_goes_by_its_own_name():
    mapping = parse_mapping(None, 2)
    assert text(mapping.plain("t")) == "t"
    assert text(mapping.joint("dq", 2)) == "dq2"
    assert not mapping.plain("t").asked


def test_the_mapping_of_the_contract():
    mapping = parse_mapping("t=time,q=pos_meas{j},dq=vel_meas{j},tau=tau_meas{j}", 2)
    assert text(mapping.plain("t")) == "time"
    assert [text(mapping.joint("q", j)) for j in (1, 2)] == ["pos_meas1", "pos_meas2"]
    assert mapping.joint("tau", 2).asked
    assert text(mapping.joint("ddq", 1)) == "ddq1"


def test_rows_of_an_array_are_counted_from_the_joint():
    mapping = parse_mapping("q=Y[{j}], dq=Y[{j+2}], tau=Y[{j-0}]", 2)
    assert text(mapping.joint("dq", 2)) == "Y[4]"
    assert text(mapping.joint("q", 2)) == "Y[2]"


def test_a_number_may_be_counted_down_from_the_joint():
    mapping = parse_mapping("q=axis{j-1}, dq=Y[{j-1}], tau=m{j+1}", 3)
    assert [text(mapping.joint("q", j)) for j in (1, 2, 3)] == ["axis0", "axis1", "axis2"]
    assert [text(mapping.joint("dq", j)) for j in (1, 3)] == ["Y[0]", "Y[2]"]
    assert [text(mapping.joint("tau", j)) for j in (1, 3)] == ["m2", "m4"]


def test_single_joints_can_be_named():
    mapping = parse_mapping("q1=shoulder,q2=elbow", 2)
    assert [text(mapping.joint("q", j)) for j in (1, 2)] == ["shoulder", "elbow"]


def test_an_empty_address_leaves_a_column_unused():
    mapping = parse_mapping("dq=,t=", 2)
    assert mapping.joint("dq", 1) is None
    assert mapping.plain("t") is None


def test_one_joint_needs_no_number():
    assert text(parse_mapping("q=entries.position", 1).joint("q", 1)) == "entries.position"


def test_every_mistake_is_listed_with_its_entry():
    with pytest.raises(ConfigError) as caught:
        parse_mapping("time,angle=q{j},q=pos,q3=x,t=time{j},tau=a{k}{j},q=b{j}", 2)
    mistakes = caught.value.mistakes
    assert len(mistakes) == 7
    assert "'time'" in mistakes[0] and "no '='" in mistakes[0]
    assert "'angle' is no role" in mistakes[1]
    assert "has no {j}" in mistakes[2]
    assert "joint 3" in mistakes[3] and "1 to 2" in mistakes[3]
    assert "only in the roles" in mistakes[4]
    assert "braces" in mistakes[5]
    assert "given twice" in mistakes[6]


def test_other_roles_are_taken_where_they_are_named():
    assert text(parse_mapping("s1x=Acc_X", 2, other_roles=["s1x"]).plain("s1x")) == "Acc_X"
    with pytest.raises(ConfigError, match="no role"):
        parse_mapping("s9x=Acc_X", 2, other_roles=["s1x"])


def test_a_unit_may_follow_a_colon():
    mapping = parse_mapping("q=angle{j}:deg, t=stamp:us, tau=robot:torque{j}:N.mm, dq=robot:speed{j}", 2)
    assert text(mapping.joint("q", 2)) == "angle2"
    assert mapping.joint("q", 2).unit.name == "deg"
    assert mapping.plain("t").unit.factor == 1e-6
    assert text(mapping.joint("tau", 1)) == "robot:torque1"
    assert text(mapping.joint("dq", 1)) == "robot:speed1" and mapping.joint("dq", 1).unit is None


@pytest.mark.parametrize("entry", ["q=angle{j}:ms", "t=time:deg", "tau=m{j}:m", "tipx=x:g", "trial=run:s"])
def test_a_unit_that_does_not_fit_is_said(entry):
    with pytest.raises(ConfigError, match="cannot be in|has no unit"):
        parse_mapping(entry, 2)


def test_the_base_s_pose_may_have_other_names():
    mapping = parse_mapping("base_x=pelvis_tx:mm,base_qw=q0", 2)
    place, turn = mapping.plain("base_x"), mapping.plain("base_qw")
    assert text(place) == "pelvis_tx" and place.unit.factor == 1e-3
    assert text(turn) == "q0" and turn.dimensions == ()
    with pytest.raises(ConfigError, match="base_qw has no such unit"):
        parse_mapping("base_qw=q0:deg", 2)


def test_a_drive_may_have_a_column_for_all_joints():
    mapping = parse_mapping("on=torque_enable,kp=gain{j},kv2=d", 2)
    assert [text(mapping.joint("on", j)) for j in (1, 2)] == ["torque_enable"] * 2
    assert [text(mapping.joint("kp", j)) for j in (1, 2)] == ["gain1", "gain2"]
    assert text(mapping.joint("kv", 2)) == "d"
    with pytest.raises(ConfigError, match="kp has no such unit"):
        parse_mapping("kp=gain{j}:N.m", 2)


names = st.text(st.characters(categories=["L", "N"], include_characters="_.[]() "), min_size=1).map(
    lambda name: f"x{name}x"
)


@given(st.dictionaries(st.sampled_from(JOINT_ROLES), names), st.integers(1, 9))
def test_what_a_mapping_says_is_what_is_found(wanted, joint):
    mapping = parse_mapping(",".join(f"{role}={name}{{j}}" for role, name in wanted.items()), 9)
    for role in JOINT_ROLES:
        expected = f"{wanted[role]}{joint}" if role in wanted else f"{role}{joint}"
        assert text(mapping.joint(role, joint)) == expected
