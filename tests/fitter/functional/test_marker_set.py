"""Marker sets: built in, and from files with mistakes."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.functional.marker_set import load_marker_set, marker_set_names, parse_marker_set
from limbcal.errors import ConfigError

GOOD = """
schema = 1
name = "my-lab"
[segments]
upper_arm_right = ["UA1", "UA2", "UA3", "EL"]
[landmarks]
lateral_epicondyle_right = "EL"
acromion_right = "AC"
"""


def test_the_promised_sets_are_built_in():
    promised = {"plug-in-gait", "cgm2", "ior", "isb", "opencap", "kineticstoolkit", "biobuddy"}
    assert promised <= set(marker_set_names())


@pytest.mark.parametrize("name", marker_set_names())
def test_every_built_in_set_is_without_mistakes_and_alike_on_both_sides(name):
    found = load_marker_set(name)
    assert found.name == name
    assert all(found.segment_of(marker) for marker in found.markers)
    if name != "kineticstoolkit":  # whose bony points are of the right arm
        for landmark in found.landmarks:
            assert landmark.replace("_right", "_left") in found.landmarks


def test_a_file_is_read(tmp_path):
    (tmp_path / "lab.toml").write_text(GOOD)
    found = load_marker_set(tmp_path / "lab.toml")
    assert found.name == "my-lab"
    assert found.markers == ("UA1", "UA2", "UA3", "EL", "AC")
    assert found.segment_of("UA2") == "upper_arm_right"
    assert found.segment_of("AC") == "scapula_right"  # on no segment's list, but acromion is part of one
    assert found.segment_of("X") is None


def test_a_name_that_is_nearly_one_is_told(tmp_path):
    with pytest.raises(ConfigError, match="did you mean 'plug-in-gait'"):
        load_marker_set("plugin-gait")
    with pytest.raises(ConfigError, match="marker set .*: Is a directory"):
        load_marker_set(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("schema = 1", "schema = 2", "schema: found '2', expected 1"),
        ("schema = 1", "schema = true", "schema: found 'True', expected 1"),
        ("schema = 1\n", "", "schema: found nothing, expected 1"),
        ('name = "my-lab"\n', "", "name: found nothing"),
        ('name = "my-lab"', 'name = "my-lab"\nsegment = 1', "segment: not a field .* did you mean 'segments'"),
        ("upper_arm_right =", "upperarm_right =", "no such segment.*did you mean 'upper_arm_right'"),
        ('"UA1"', "7", "segments.upper_arm_right: found .* expected a list of marker names"),
        ('"UA1", "UA2", "UA3", "EL"', "", "expected a list of marker names"),
        ('"UA2"', '"UA1"', "'UA1' is on upper_arm_right too"),
        ("[landmarks]", 'forearm_right = ["EL"]\n[landmarks]', "'EL' is on upper_arm_right too"),
        ("lateral_epicondyle_right", "lateral_epicondile_right", "did you mean 'lateral_epicondyle_right'"),
        ('acromion_right = "AC"', "acromion_right = 3", "landmarks.acromion_right: found '3'"),
        (
            'acromion_right = "AC"',
            'acromion_right = "UA1"',
            "'UA1' is on upper_arm_right, expected it on scapula_right",
        ),
        ('acromion_right = "AC"', 'medial_epicondyle_right = "EL"', "'EL' is lateral_epicondyle_right too"),
        ("[segments]", "[segments", "not TOML"),
    ],
)
def test_a_mistake_is_one_sentence_with_what_was_expected(old, new, said):
    with pytest.raises(ConfigError, match=said) as caught:
        parse_marker_set(GOOD.replace(old, new, 1), "lab.toml")
    assert all(mistake.startswith("lab.toml: ") and "\n" not in mistake for mistake in caught.value.mistakes)


def test_every_mistake_is_told():
    with pytest.raises(ConfigError) as caught:
        parse_marker_set('schema = 3\n[segments]\ntorso = ["A"]\n[landmarks]\nnose = "A"\n', "lab.toml")
    assert len(caught.value.mistakes) == 4


values = st.recursive(
    st.one_of(st.integers(-5, 5), st.booleans(), st.sampled_from(['"A"', '""', "1.5", "1979-05-27"])).map(str),
    lambda inner: st.lists(inner, max_size=3).map(lambda x: "[" + ", ".join(str(i).lower() for i in x) + "]"),
    max_leaves=5,
)


@settings(max_examples=200)
@given(
    st.lists(
        st.tuples(st.sampled_from(["schema", "name", "segments", "landmarks", "x"]), values),
        unique_by=lambda x: x[0],
    ),
    st.booleans(),
)
def test_whatever_stands_in_it_is_read_or_refused(fields, with_table):
    text = "\n".join(
        f"{key} = {str(value).lower() if value in ('True', 'False') else value}" for key, value in fields
    )
    if with_table:
        text += "\n[extra]\na = 1\n"
    with pytest.raises(ConfigError):  # none of these has segments
        parse_marker_set(text, "lab.toml")


def test_a_pointer_is_read_and_its_mistakes_are_told():
    probe = parse_marker_set(GOOD + "[probe]\nP1 = [0, 0.1, 0.2]\n", "lab.toml").probe
    assert probe == {"P1": (0.0, 0.1, 0.2)}
    with pytest.raises(ConfigError, match=r"probe.P1: found 'here', expected \[x, y, z\]"):
        parse_marker_set(GOOD + '[probe]\nP1 = "here"\n', "lab.toml")
