"""The most likely motion against a dense solution of the same equations."""

import numpy as np
import pytest

from arm.marker_kinematics import slopes_room
from fitter.limb import motion_smoother
from fitter.limb.frame_equations import frame_equations
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import FREEDOM, SWAY
from fitter.limb.motion_smoother import JERK_DENSITY, SWAY_JERK_DENSITY, smooth
from tests.fitter.limb.simulated_task import simulated_task

DT = 0.02


@pytest.fixture(scope="module")
def known():
    """Return a leg that swings slowly, its markers off by their noise."""
    truth = simulated_task(n=30)
    t = np.arange(30) * DT
    q = np.zeros_like(truth.q)
    q[:, SWAY:] = truth.q[0, SWAY:] + 0.2 * np.sin(2.0 * np.pi * t[:, None] + np.arange(6.0))
    chain = truth.markers.chain(truth.geometry)
    frames = truth.task.frames._replace(p=np.tile(truth.task.frames.p[:1], (30, 1)), t=t)
    y = predicted(chain, frames, q) + 1e-3 * np.random.default_rng(0).normal(size=frames.y.shape)
    return chain, frames._replace(y=y), truth.markers.std, truth.task.angles, q


def scales(chain):
    return np.where(chain.revolute, JERK_DENSITY, SWAY_JERK_DENSITY) * DT**5


def roughness(chain, q):
    """Return the prior's information on all angles of a motion by its definition, dense."""
    D = np.diff(np.eye(len(q)), 3, axis=0)
    weight = (FREEDOM + 1.0) / (FREEDOM + np.diff(q, 3, axis=0) ** 2 / scales(chain)) / scales(chain)
    return np.einsum("rk,rl,ri,ij->kilj", D, D, weight, np.eye(q.shape[1])).reshape(q.size, q.size)


def information(chain, frames, std, prior, q):
    n = q.shape[1]
    total, pull, room = np.zeros((q.size, q.size)), np.zeros(q.shape), slopes_room(n, 0)
    A, a = np.empty((n, n)), np.empty(n)
    for k in range(len(q)):
        frame_equations(chain, frames, k, std**2, prior, q[k], room, A, a)
        total[k * n : (k + 1) * n, k * n : (k + 1) * n] = A
        pull[k] = a
    return total, pull


def test_nothing_is_left_to_gain_at_the_answer(known):
    chain, frames, std, prior, q = known
    found = smooth(chain, frames, std, prior, DT, q + 0.02)
    assert found.converged
    H = roughness(chain, found.q)
    A, a = information(chain, frames, std, prior, found.q)
    step = np.linalg.solve(A + H, a.ravel() - H @ found.q.ravel())
    assert np.abs(step).max() < 2e-3
    room, spare = slopes_room(q.shape[1], 0), (np.empty((q.shape[1], q.shape[1])), np.empty(q.shape[1]))

    def cost(x):
        own = sum(frame_equations(chain, frames, k, std**2, prior, x[k], room, *spare) for k in range(len(x)))
        jerk = np.log1p(np.diff(x, 3, axis=0) ** 2 / scales(chain) / FREEDOM)
        return own + float((FREEDOM + 1.0) * np.sum(jerk))

    assert cost(found.q) <= cost(q)
    assert np.sqrt(np.mean((found.q[:, SWAY:] - q[:, SWAY:]) ** 2)) < 0.02


def test_variances_are_those_of_the_dense_inverse(known):
    chain, frames, std, prior, q = known
    found = smooth(chain, frames, std, prior, DT, q)
    A, _ = information(chain, frames, std, prior, found.q)
    alike = 1.0 / (2.0 * 12.0 * DT)  # frames whose error of the skin is one: 12 Hz pass
    expected = np.sqrt(np.diag(np.linalg.inv(A / alike + roughness(chain, found.q)))).reshape(q.shape)
    np.testing.assert_allclose(found.std, expected, rtol=1e-6)


def test_a_gap_is_bridged_and_its_error_grows(known):
    chain, frames, std, prior, q = known
    y = frames.y.copy()
    y[12:17] = np.nan
    found = smooth(chain, frames._replace(y=y), std, prior, DT, q)
    assert np.abs(found.q[14, SWAY:] - q[14, SWAY:]).max() < 0.2
    whole = smooth(chain, frames, std, prior, DT, q)
    assert np.all(found.std[14, SWAY:] > whole.std[14, SWAY:])


def test_a_blow_is_followed_and_rest_stays_smooth(known):
    """A joint's speed changes within a frame, by 40 rad/s, as of a wrist that is flicked, and back."""
    chain, frames, std, prior, q = known
    blown = q.copy()
    blown[:, SWAY + 3] += np.interp(np.arange(30), [14, 16], [0.0, 1.6])
    rng = np.random.default_rng(1)
    y = predicted(chain, frames, blown) + 1e-3 * rng.normal(size=frames.y.shape)
    found = smooth(chain, frames._replace(y=y), std, prior, DT, q)
    off = np.abs(found.q[:, SWAY:] - blown[:, SWAY:])
    assert found.converged and off.max() < 0.05


def test_frames_solved_by_themselves_end_where_all_together_do(known, monkeypatch):
    """One blow in a long motion: all but the frames around it stay."""
    chain, frames, std, prior, q = known
    many = np.tile(np.arange(30), 5)
    blown = q[many]
    blown[:, SWAY:] = np.cumsum(np.full((150, 6), 1e-3), axis=0)
    blown[:, SWAY + 3] += np.interp(np.arange(150), [70, 72], [0.0, 1.6])
    more = frames.rows(many)._replace(t=np.arange(150) * DT)
    y = predicted(chain, more, blown)
    more = more._replace(y=y + 1e-3 * np.random.default_rng(2).normal(size=y.shape))
    parts, settle = [], motion_smoother._Problem.settle
    monkeypatch.setattr(motion_smoother._Problem, "settle", lambda *a: parts.append(a[1:]) or settle(*a))
    slow = blown.copy()
    slow[:, SWAY + 3] = np.interp(np.arange(150), [40, 102], blown[[0, 149], SWAY + 3])
    found = smooth(chain, more, std, prior, DT, slow)
    assert found.converged and parts and all(end - first < 75 for first, end in parts)
    monkeypatch.setattr(motion_smoother, "_FEW", 0.0)
    monkeypatch.setattr(motion_smoother, "_CONVERGED_RAD", 1e-6)
    together = smooth(chain, more, std, prior, DT, slow)
    assert np.abs(found.q - together.q).max() < 5e-3
    np.testing.assert_allclose(found.std, together.std, rtol=0.02)


def test_less_jerk_is_smoother(known):
    chain, frames, std, prior, q = known
    rough, calm = (smooth(chain, frames, std, prior, DT, q, share).q for share in (1.0, 1e-4))
    assert np.sum(np.diff(calm, 3, axis=0) ** 2) < 0.5 * np.sum(np.diff(rough, 3, axis=0) ** 2)


@pytest.mark.parametrize("n", [1, 3])
def test_too_few_frames_for_jerk_are_each_by_itself(known, n):
    chain, frames, std, prior, q = known
    few = frames.rows(np.arange(n))
    found = smooth(chain, few, std, prior, DT, q[:n])
    alone = smooth(chain, frames.rows(np.arange(1)), std, prior, DT, q[:1])
    np.testing.assert_allclose(found.q[0], alone.q[0], atol=1e-4)
    np.testing.assert_allclose(found.std[0], alone.std[0], rtol=1e-3)
