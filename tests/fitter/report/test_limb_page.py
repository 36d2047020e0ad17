"""The page of a person's limb."""

import numpy as np

from benchmarks.simulated_people.person import person, with_gaps
from fitter.limb.json_document import document
from fitter.limb.limb_calibration import calibrate
from fitter.limb.marker_errors import scores_of
from fitter.report.limb_page import write_limb_page
from limbcal.note import Note


def test_the_page_has_segments_centres_rivals_and_pictures(tmp_path):
    truth = person(n=150)
    recordings = [with_gaps(truth.recordings[0], np.random.default_rng(0))]
    fit = calibrate(recordings, truth.marker_set, "human-arm-right", fit_frames=100)
    answer = document(fit, scores_of(fit, recordings, [], 0))
    page = tmp_path / "page.html"
    write_limb_page(page, fit, answer, recordings, [Note("gap", "a marker was away")])
    text = page.read_text()
    assert text.count("data:image/png") == 4
    for words in ("upper_arm", "shoulder_right", "elbow_right", "SCoRE (95 %)", "a marker was away", "trial0.trc"):
        assert words in text, words
