"""The page of a whole person."""

from benchmarks.simulated_people.body import fitted
from fitter.body.document import body_document
from fitter.limb.marker_errors import scores_of
from fitter.report.body_page import lowest_and_highest, write_body_page
from limbcal.note import Note


def test_the_page_has_lengths_by_side_and_pictures(tmp_path):
    person, fit = fitted()
    answer = body_document(fit, scores_of(fit, [person.recording], [], 0))
    page = tmp_path / "page.html"
    write_body_page(page, fit, answer, [person.recording], [Note("gap", "a marker was away")])
    text = page.read_text()
    assert text.count("data:image/png") == 3
    for words in ("thigh_right", "hip_left", "lumbar", "a marker was away", "squats.trc"):
        assert words in text, words


def test_the_highest_posture_is_drawn_before_the_lowest():
    _, fit = fitted()
    standing, squatting = lowest_and_highest(fit).axes
    heights = [max(line.get_ydata().max() for line in axes.lines) for axes in (standing, squatting)]
    assert heights[0] > heights[1] + 0.2
