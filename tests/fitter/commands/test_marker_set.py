"""`fitter marker-set`: a draft of the clusters that a recording shows."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.person import person
from tests.fitter.commands.test_limb import written_trc


@pytest.fixture(scope="module")
def recording():
    """Return a person's arm in motion; one marker has a name and is never seen."""
    plain = person(n=300, seed=2).recordings[0]
    away = np.full((300, 1, 3), np.nan)
    return replace(plain, names=(*plain.names, "away"), positions=np.hstack([plain.positions, away]))


def test_clusters_of_markers_that_keep_their_distances_are_drafted(fitter, tmp_path, recording):
    out = tmp_path / "my-lab.toml"
    drafted = fitter("marker-set", written_trc(tmp_path / "move.trc", recording), "--out", out)
    assert drafted.code == 0, drafted.errors
    document = drafted.document
    clusters = {frozenset(one["markers"]): one for one in document["clusters"]}
    assert frozenset(("B1", "B2", "B3", "B4")) in clusters
    assert all(0.0 < one["scatter_mm"] < document["rigid_mm"] for one in document["clusters"])
    assert document["rigid_mm"] == 8.0 and document["out"] == str(out)
    assert not any("away" in markers for markers in clusters)
    draft = tomllib.loads(out.read_text())
    assert draft["name"] == "my-lab" and "cluster_1" in draft["segments"]
    assert {frozenset(markers) for markers in draft["segments"].values()} == set(clusters)
    n = len(recording.names) - 1
    assert f"{len(clusters)} clusters of {n} markers -> {out}: give each its segment's name" in drafted.said
    assert "B1, B2, B3, B4" in drafted.said


def test_a_draft_that_cannot_be_written_is_said(fitter, tmp_path, recording):
    trial = written_trc(tmp_path / "move.trc", recording)
    wrong = fitter("marker-set", trial, "--out", tmp_path / "draft.json")
    assert wrong.code == 2 and ".toml" in wrong.errors[0]
    (tmp_path / "draft.toml").mkdir()
    assert fitter("marker-set", trial, "--out", tmp_path / "draft.toml").code != 0
