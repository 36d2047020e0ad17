"""What to do next is one sentence for every verdict."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from fitter.diagnosis.next_experiment import next_experiment

EFFECTS, VERDICTS = st.lists(st.sampled_from(sorted(catalogue())), max_size=3), ("named", "ambiguous", "none")


@given(st.sampled_from((*VERDICTS, "unexplained")), EFFECTS, st.lists(st.integers(1, 3)), st.lists(st.just("q1")))
def test_it_is_a_sentence(verdict, alike, joints, depends_on):
    said = next_experiment(verdict, alike, joints, depends_on)
    assert said[0].isupper() and said.endswith(".") and "{" not in said


@pytest.mark.parametrize(
    ("verdict", "alike", "depends_on", "said"),
    [
        ("ambiguous", ["torque_offset", "coulomb_asymmetry"], [], "joint 2 slowly both ways"),
        ("ambiguous", ["cogging", "joint_spring"], [], "until cogging and joint_spring no longer look alike"),
        ("unexplained", [], ["q1", "t"], "Vary q1 alone"),
        ("unexplained", [], ["t"], "Repeat one and the same motion"),
        ("none", [], [], "Nothing more is needed"),
        ("named", ["cogging"], [], "the cause at joint 2"),
    ],
)
def test_it_depends_on_what_was_found(verdict, alike, depends_on, said):
    assert said in next_experiment(verdict, alike, [2, 2], depends_on)
