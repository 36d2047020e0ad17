"""The page of a diagnosis of markers."""

import numpy as np

from arm.arm_file import load_arm
from arm.model import Effect
from fitter.marker_diagnosis.marker_finding import MarkerCandidate, MarkerFinding
from fitter.marker_diagnosis.marker_hypotheses import Suspicion
from fitter.report.marker_diagnosis import write_marker_report


def test_the_page_names_causes_rivals_and_every_marker(tmp_path):
    tried = Suspicion(Effect("label_swap", {}, markers=("A", "B")), {}, 12.3, (1,))
    finding = MarkerFinding(
        verdict="named",
        complete=True,
        causes=[],
        candidates=[MarkerCandidate(tried, 0.8, 0.9)],
        confusable=[],
        next_experiment="exchange the two labels",
        before={"A": 30.0, "B": np.nan},
        after={"A": 3.0, "B": np.nan},
        rms_mm=(20.0, 3.0),
        gain=0.9,
        ci95=(0.8, 0.95),
        wander=0.4,
        arm=load_arm("dd-arm"),
        by_trial=[("walk", np.array([30.0, np.nan]), np.array([3.0, np.nan]))],
    )
    write_marker_report(finding, ["label_swap, A, B: they have each other's names"], "Wrong.", tmp_path)
    page = (tmp_path / "report.html").read_text()
    assert (tmp_path / "diagnosis-markers.png").stat().st_size > 1000
    for said in ("label_swap", "A, B", "exchange the two labels", "12.3", "0.40 times"):
        assert said in page
    assert "http://" not in page and "https://" not in page
