"""How a marker set fits a recording."""

from dataclasses import replace

from fitter.functional.marker_set import load_marker_set, parse_marker_set
from fitter.functional.marker_set_fit import best_built_in, built_in_advice, fit_marker_set

SET = parse_marker_set(
    'schema = 1\nname = "lab"\n[segments]\nthigh_left = ["T1", "T2", "T3"]\nshank_left = ["S1", "S2", "S3"]\n'
    '[landmarks]\nlateral_malleolus_left = "S3"\n',
    "lab.toml",
)


def texts(fit, kind):
    return [note.text for note in fit.notes if note.kind == kind]


def test_a_set_that_is_all_there_has_nothing_to_say():
    fit = fit_marker_set(SET, ["S3", "T1", "T2", "T3", "S1", "S2"])
    assert fit.notes == ()
    assert fit.posed == ("thigh_left", "shank_left")
    assert fit.landmarks == {"lateral_malleolus_left": "S3"}


def test_missing_markers_are_told_one_by_one_with_what_they_may_be_called():
    fit = fit_marker_set(SET, ["T1", "T2", "T3", "S1", "s_2", "S.3"])
    assert fit.missing == ("S2", "S3")
    assert fit.unused == ("s_2", "S.3")
    first, second = texts(fit, "missing_marker")
    assert first == "marker 'S2' on shank_left: not in the recording; did you mean 's_2'?"
    assert second.startswith(
        "marker 'S3' on shank_left, its lateral_malleolus_left: not in the recording; did you mean"
    )
    assert texts(fit, "unused_marker") == ["no segment of marker set lab uses s_2, S.3"]
    assert texts(fit, "too_few_markers") == [
        "shank_left has 1 of its 3 markers, expected three for a pose of its own"
    ]
    assert fit.posed == ("thigh_left",)


def test_a_name_that_is_used_is_nobody_elses_near_miss():
    fit = fit_marker_set(SET, ["T1", "T2", "T3", "S1", "S2"])
    assert "did you mean" not in texts(fit, "missing_marker")[0]


def test_a_marker_of_the_other_side_is_no_near_miss():
    own = replace(SET, segments={"shank_right": ("r_mknee", "r_knee", "r_ankle")}, landmarks={})
    fit = fit_marker_set(own, ["r_knee", "r_ankle", "L_mknee", "mknee.l"])
    (text,) = texts(fit, "missing_marker")
    assert "'r_mknee'" in text and "did you mean" not in text
    fit = fit_marker_set(own, ["r_knee", "r_ankle", "R.mknee"])
    assert "did you mean 'R.mknee'" in texts(fit, "missing_marker")[0]


def test_another_set_is_proposed_where_most_is_missing():
    markers = load_marker_set("biobuddy").markers
    assert best_built_in(markers) == ("biobuddy", 1.0)
    (text,) = texts(fit_marker_set(load_marker_set("cgm2"), markers), "wrong_marker_set")
    assert "of the 38 markers of marker set cgm2" in text and "of biobuddy there are 100 %" in text


def test_plug_in_gait_is_told_from_cgm2_that_shares_its_names():
    assert best_built_in([*load_marker_set("plug-in-gait").markers, "X"])[0] == "plug-in-gait"
    assert best_built_in(load_marker_set("cgm2").markers)[0] == "cgm2"


def test_no_marker_at_all_is_no_set():
    fit = fit_marker_set(SET, [])
    assert len(texts(fit, "missing_marker")) == 6
    assert fit.segments == {}


def test_where_no_built_in_set_is_meant_a_draft_is_advised():
    assert "cgm2" in built_in_advice(load_marker_set("cgm2").markers)
    others = [f"P{k}" for k in range(40)] + list(load_marker_set("opencap").markers)[:3]
    assert "fitter marker-set" in built_in_advice(others) and "no built-in set fits" in built_in_advice(others)
