"""The page of a person's limb."""

from dataclasses import replace

import numpy as np

from fitter.limb.json_document import document
from fitter.limb.limb_calibration import calibrate
from fitter.report.limb_figures import gaps_and_swaps, stick_figure
from fitter.report.limb_page import write_limb_page
from limbcal.note import Note
from tests.fitter.limb.simulated_person import person, with_gaps


def test_the_page_has_segments_centres_rivals_and_pictures(tmp_path):
    truth = person(n=150)
    recordings = [with_gaps(truth.recordings[0], np.random.default_rng(0))]
    fit = calibrate(recordings, truth.marker_set, "human-arm-right", fit_frames=100)
    answer = document(fit, recordings, [], 0)
    page = tmp_path / "page.html"
    write_limb_page(page, fit, answer, recordings, [Note("gap", "a marker was away")])
    text = page.read_text()
    assert text.count("data:image/png") == 4
    for words in ("upper_arm", "shoulder_right", "elbow_right", "SCoRE (95 %)", "a marker was away", "trial0.trc"):
        assert words in text, words
    titles = [axes.get_title() for axes in stick_figure(fit).axes]
    assert titles == ["sagittal plane", "frontal plane", "transverse plane"]


def test_a_gap_is_a_grey_bar_and_an_exchange_a_red_one():
    recording = person(n=100).recordings[0]
    positions = recording.positions.copy()
    positions[20:40, 0] = np.nan
    recording = replace(recording, positions=positions)
    names = recording.names[:2]
    swap = Note("swapped", "two were exchanged", source=recording.path, columns=names, from_s=0.2, to_s=0.6)
    (axes,) = gaps_and_swaps([recording], names, [swap]).axes
    bars = [one.get_paths()[0].get_extents() for one in axes.collections if one.get_paths()]
    assert any(np.isclose(bar.x0, 0.4) and np.isclose(bar.x1, 0.8) for bar in bars)
    assert sum(np.isclose(bar.x0, 0.2) and np.isclose(bar.x1, 0.6) for bar in bars) == 2
