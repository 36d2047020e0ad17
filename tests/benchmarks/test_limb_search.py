"""The shares of starts that the search of a limb is judged by."""

import pytest

from benchmarks.limb_search import summary


def document(rms, apart, centres, cost):
    own = {
        "marker_rms_mm": rms, "apart_mm": apart, "centres_apart_mm": centres, "cost": cost, "cpu_s": 30.0,
        "generations": 100,
    }  # fmt: skip
    bundle = {**own, "marker_rms_mm": 4.0, "apart_mm": 0.0, "centres_apart_mm": 0.0, "cost": 0.0}
    return {"bundle": bundle, "ga": own}


def test_shares_count_starts_within_a_millimetre():
    starts = [
        document(4.1, 0.5, 0.9, 5.0),
        document(4.9, 1.5, 2.0, 8.0),
        document(3.2, 0.9, 30.0, 40.0),  # fits better, elsewhere
        document(5.5, 2.0, 9.0, -20.0),  # a better minimum than the bundle fit's is no other's failure
    ]
    found = summary(starts, "ga")
    assert found["share_rms"] == 0.75
    assert found["share_apart"] == 0.5
    assert found["share_centres"] == 0.25
    assert found["share_no_worse"] == 0.75
    assert found["rms_mm"] == pytest.approx(4.5)
    assert summary(starts, "bundle")["share_centres"] == 1.0
