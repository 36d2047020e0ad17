"""The page that a diagnosis leaves behind."""

import base64
import json
import re

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.diagnosis import diagnose
from fitter.diagnosis.held_out import smooth
from fitter.report.diagnosis_report import write_diagnosis
from fitter.report.diagnosis_rivals import rivals, shown
from fitter.report.diagnosis_traces import traces
from fitter.report.diagnosis_words import fell, groups, headline, measured, place, rounded
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import DeviceError
from tests.fitter.pendulum import pendulum, swings

SPRING = (Effect("joint_spring", {"stiffness_N_m_rad": 1.0, "rest_angle_rad": 0.3}, joints=(1,)),)
OFFSET = (Effect("torque_offset", {"torque_N_m": 0.3}, joints=(1,)),)
SECTIONS = ["What is wrong", "The cause", "The rivals", "The gain", "What is left", "The next experiment"]


def diagnosed(effects):
    motions = swings(effects, trials=4)
    return diagnose(pendulum(), motions[:2], motions[2:])


@pytest.fixture(scope="module")
def spring():
    return diagnosed(SPRING)


@pytest.fixture(scope="module")
def offset():
    return diagnosed(OFFSET)


@pytest.fixture(scope="module")
def nothing():
    motions = swings((), trials=4)
    return diagnose(pendulum(), motions[:2], motions[2:])


@pytest.fixture(scope="module")
def page(spring, tmp_path_factory):
    folder = tmp_path_factory.mktemp("diagnosis")
    write_diagnosis(spring, folder)
    return folder, (folder / "report.html").read_text(encoding="utf-8")


def words(text):
    """Return a page without pictures and markup."""
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", re.sub(r"data:[^\"]+", "", text)))


def test_it_is_read_from_top_to_bottom_without_a_network(page):
    _, text = page
    order = [text.index(f"<h2>{title}</h2>") for title in SECTIONS]
    assert order == sorted(order)
    assert text.index("<img") < order[1]  # the picture comes before the cause
    assert "http://" not in text and "https://" not in text and 'src="data:' in text


def test_the_cause_is_said_in_plain_words_with_size_and_place(page, spring):
    _, text = page
    said = words(text)
    assert catalogue()["joint_spring"].sentence in said
    assert "(joint_spring, joint 1)" in said
    stiffness = spring.finding.causes[0].parameters["stiffness_N_m_rad"]
    value, around = measured(stiffness)
    assert f"stiffness_N_m_rad {value} {around} N m/rad" in said
    assert "joint_spring, joint 1" in said and "beaten" in said
    assert spring.finding.next_experiment in said


def test_pictures_lie_beside_the_page_and_inside_it(page):
    folder, text = page
    inside = {base64.b64decode(found) for found in re.findall(r"base64,([^\"]+)", text)}
    beside = {path.name: path.read_bytes() for path in folder.glob("*.png")}
    assert set(beside) == {f"diagnosis-{name}.png" for name in ("residual", "places", "angles", "gains")}
    assert inside == set(beside.values())
    assert all(png.startswith(b"\x89PNG") for png in inside)


def test_numbers_and_arm_lie_beside_it(page, spring):
    folder, _ = page
    document = json.loads((folder / "diagnosis.json").read_text())
    assert document["verdict"] == "named" and document["causes"][0]["effect"] == "joint_spring"
    assert load_arm(folder / "extended.toml").effects[0].name == "joint_spring"


def test_the_same_diagnosis_makes_the_same_page(spring, page, tmp_path):
    write_diagnosis(spring, tmp_path)
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page[1]


def test_what_looks_alike_is_said_as_such(offset, tmp_path):
    write_diagnosis(offset, tmp_path)
    said = words((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert offset.finding.verdict == "ambiguous"
    assert "this data cannot tell" in said and "explain this data equally well" in said
    for effect in ("torque_offset", "coulomb_asymmetry"):
        assert f"({effect}, joint 1)" in said
    (group,) = groups(offset)
    assert {cause.effect for cause in group} == {"torque_offset", "coulomb_asymmetry"}
    listed = rivals(offset, offset.search.causes[0])
    assert listed[0].verdict == "named" and listed[1].verdict == "as good: can't be distinguished"
    assert abs(listed[0].gain - listed[1].gain) < 0.01


def test_where_nothing_is_wrong_it_says_so(nothing, tmp_path):
    assert nothing.finding.verdict == "none"
    write_diagnosis(nothing, tmp_path)
    said = words((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "Nothing is wrong that this data could show" in said
    assert "The gain" not in said and "How well it simulates" in said and "wrong, because" not in said


def test_the_winner_leads_and_every_candidate_is_listed_once(spring):
    listed = rivals(spring, spring.search.causes[0])
    assert len(listed) == len(spring.search.first) and len({one.name for one in listed}) == len(listed)
    rows, rest = shown(listed)
    assert rows[0].verdict == "named" and {*rows, *rest} == set(listed)
    assert all(rows[0].gain >= one.gain - 0.01 for one in listed)


def test_what_is_left_shrinks_with_the_cause(spring):
    judging = [trace for trace in traces(spring) if not trace.motion.learn]
    assert len(judging) == 2 and all(len(trace.residuals) == len(trace.simulated) == 2 for trace in judging)
    for trace in judging:
        before, after = (np.nansum(residual**2) for residual in trace.residuals)
        assert after < 0.2 * before
        before, after = (np.abs(q - trace.motion.trial.q).max() for q in trace.simulated)
        assert after < before


def test_smoothing_keeps_gaps_and_constants_and_bridges_nothing():
    left = np.full((1000, 2), 0.7)
    left[300:400, 0] = np.nan
    left[600:, 1] = np.nan
    left[599, 1] = 1e6  # beside a gap the columns' filter still has what was in it
    smoothed = smooth(left, 0.002, 5.0)
    assert np.all(np.isnan(smoothed[300:400, 0])) and np.all(np.isnan(smoothed[600:, 1]))
    assert np.nanmax(np.abs(smoothed - 0.7)) < 1e-9
    assert np.isfinite(smoothed[:, 0]).sum() == 1000 - 100 - 60


def test_smoothing_halves_the_power_at_the_corner():
    t = np.arange(20000) * 1e-3
    wave = np.sin(2.0 * np.pi * 2.0 * t)[:, None]
    assert np.mean(smooth(wave, 1e-3, 2.0)[4000:-4000] ** 2) == pytest.approx(0.25, rel=0.01)


@pytest.mark.parametrize(
    ("value", "half", "said"),
    [(1.23456, 0.0123, "1.235"), (-0.5, 0.25, "-0.50"), (1234.5, 56.0, "1234"), (0.1, np.nan, "0.1")],
)
def test_values_have_the_digits_that_tell_something(value, half, said):
    assert rounded(value, half) == said


def test_small_words():
    assert place([1]) == "joint 1" and place([1, 2, 3]) == "joints 1, 2 and 3" and place([]) == "the whole arm"
    assert fell(0.5) == "falls by 50 %" and fell(-0.5) == "grows by 50 %"
    assert fell(-3.0) == "grows to 4 times what it was" and "cannot be compared" in fell(-np.inf)
    assert measured(FittedParameter(0.5, np.nan, "rad", False)) == ("0.5 (28.6°)", "not known")


def test_the_headline_has_the_size(spring):
    said = headline(spring)
    assert said.startswith("The simulation is wrong, because ") and "N m rms" in said and "°" in said


def test_a_place_that_cannot_be_written_to(spring, tmp_path):
    with pytest.raises(DeviceError, match="cannot be written: No such file"):
        write_diagnosis(spring, tmp_path / "nowhere")
