"""What the data leaves open."""

import numpy as np

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.model import Arm, Joint
from fitter.data.trial import Trial
from fitter.kinematics.gauge import Gauge
from fitter.kinematics.geometry_fit import fit_kinematics
from fitter.kinematics.tip_basis import geometry_of, with_geometry


def poses(arm, n=400, seed=0):
    q = np.random.default_rng(seed).uniform(-1.5, 1.5, (n, arm.n_joint))
    return Trial("p", np.arange(n) * 0.01, 0.01, q, np.ones_like(q), 0 * q, tip=tip_position(arm, q))


def freedoms(arm):
    return {freedom.parameters: freedom.why for freedom in fit_kinematics(arm, [poses(arm)]).gauge}


def test_the_paper_s_arm():
    """d1 and d2 are along the base's z; alpha1, beta1 and joint 1's zero are how the base is turned."""
    found = freedoms(load_arm("dd-arm"))
    assert set(found) == {("d1",), ("d2",), ("alpha1",), ("beta1",), ("theta_offset1",)}
    assert "base is turned" in found["theta_offset1",]
    assert "shows nothing" in found["d2",]


def test_parallel_axes_away_from_the_base_share_their_offsets():
    alphas = (0.0, np.pi / 2, 0.0)
    arm = Arm("elbow", tuple(Joint(alpha_rad=alpha, a_m=0.2, d_m=0.1) for alpha in alphas))
    found = freedoms(arm)
    assert "parallel" in found["d2", "d3"]


def test_along_a_freedom_the_tip_moves_as_before():
    alphas = (0.0, np.pi / 2, 0.0)
    arm = Arm("elbow", tuple(Joint(alpha_rad=alpha, a_m=0.2, d_m=0.1) for alpha in alphas))
    moved = geometry_of(arm)
    moved[[1, 2], 2] += [0.05, -0.05]
    q = poses(arm).q
    there, before = tip_position(with_geometry(arm, moved), q), tip_position(arm, q)
    assert np.allclose(there - there.mean(axis=0), before - before.mean(axis=0), atol=1e-12)


def test_a_freedom_says_what_is_known_and_given_what():
    together = Gauge(("d2", "d3"), "only the sum shows")
    assert together.sentence({}) == "not identified: d2, d3: only the sum shows"
    assert (
        together.sentence({"d2"}) == "identified only with d3 as the arm file has it given: d2: only the sum shows"
    )
    turned = Gauge(("theta_offset1",), "the base turns")
    assert turned.sentence({"theta_offset1"}).startswith(
        "identified only with the base as the arm file has it given"
    )
