"""Bony points by a pointer, on a segment that is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fitter.functional.marker_set import MarkerSet
from fitter.limb.probing import with_probed
from limbcal.errors import ConfigError, DataError
from protocol.markers.recording import MarkerRecording

CLUSTER = np.array([[0.05, 0.0, 0.0], [0.0, 0.06, 0.0], [0.0, 0.0, 0.04]])
PROBE = {"P1": (0.0, 0.0, 0.1), "P2": (0.03, 0.0, 0.15), "P3": (-0.03, 0.01, 0.2)}
SET = MarkerSet("lab", {"upper_arm_right": ("U1", "U2", "U3")}, {}, PROBE)
POINT = np.array([0.01, -0.2, 0.03])


def recorded(rng, n=30, stray_m=0.0):
    """Return a recording in which the tip touches a point of the segment, and where that point was."""
    R, S = (Rotation.random(n, rng).as_matrix() for _ in range(2))
    p = rng.normal(size=(n, 3))
    tip = np.einsum("nij,j->ni", R, POINT) + p
    segment = np.einsum("nij,mj->nmi", R, CLUSTER) + p[:, None]
    pointer = np.einsum("nij,mj->nmi", S, np.array(list(PROBE.values()))) + tip[:, None]
    pointer += stray_m * rng.normal(size=(n, 1, 3))
    names = ("U1", "U2", "U3", *PROBE)
    return MarkerRecording("p.trc", 50.0, names, np.concatenate([segment, pointer], axis=1), "m", "+z"), tip


def test_a_probed_point_is_carried_by_its_segment():
    rng = np.random.default_rng(3)
    probing, _ = recorded(rng)
    motion, wanted = recorded(rng)
    bare = replace(motion, names=motion.names[:3], positions=motion.positions[:, :3])
    found = with_probed([bare], {"medial_epicondyle_right": probing}, SET)
    name = found.marker_set.landmarks["medial_epicondyle_right"]
    np.testing.assert_allclose(found.recordings[0].of([name])[:, 0], wanted, atol=1e-9)
    assert name in found.marker_set.computed
    assert [note.kind for note in found.notes] == ["probed"]


def test_a_tip_that_strays_rests_on_nothing():
    probing, _ = recorded(np.random.default_rng(4), stray_m=0.03)
    with pytest.raises(DataError, match="expected it to rest on medial_epicondyle_right"):
        with_probed([], {"medial_epicondyle_right": probing}, SET)


def test_what_is_missing_is_said():
    probing, _ = recorded(np.random.default_rng(5))
    with pytest.raises(ConfigError, match=r"under \[probe\], expected three"):
        with_probed([], {"medial_epicondyle_right": probing}, replace(SET, probe={}))
    with pytest.raises(ConfigError, match="no such landmark"):
        with_probed([], {"elbow": probing}, SET)
    with pytest.raises(ConfigError, match="thigh_right has 0 markers"):
        with_probed([], {"greater_trochanter_right": probing}, SET)
