"""What a mistyped name may have meant."""

from hypothesis import given
from hypothesis import strategies as st

from limbcal.suggestion import did_you_mean

NAMES = ["dd-arm", "dd-arm-vertical", "joint_spring", "coulomb"]


def test_the_nearest_name_is_suggested():
    assert did_you_mean("joint-sprng", NAMES) == "; did you mean 'joint_spring'?"
    assert did_you_mean("DD_ARM", NAMES) == "; did you mean 'dd-arm'?"
    assert did_you_mean("wheel", NAMES) == ""
    assert did_you_mean("wheel", []) == ""


@given(st.sampled_from(NAMES), st.data())
def test_two_letters_exchanged_are_recognised(name, data):
    k = data.draw(st.integers(0, len(name) - 2))
    typed = name[:k] + name[k + 1] + name[k] + name[k + 2 :]
    assert did_you_mean(typed, NAMES) == f"; did you mean {name!r}?"


def test_a_name_is_near_with_three_letters_of_five():
    assert did_you_mean("abcxy", ["abcde"]) == "; did you mean 'abcde'?"
    assert did_you_mean("abxy", ["abcd"]) == ""
    assert did_you_mean("--arm", ["--alpha", "--Arm"]) == "; did you mean '--Arm'?"
