"""An arm with something hidden in it: planar links under a PD law, simulated by nobody else's code.

Lagrange's equations with the mass matrix from the Jacobians of the links' centres, Heun's step, and friction
as an impulse at the end of each step that is as large as it may be and no larger than it must be to stop the
joint (projected Gauss-Seidel): a joint sticks where friction can hold it. The drive, the transmission and what
the joints feel are written out from the definitions of the effects, not taken from their catalogue.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Columns of `HiddenArm.links`: length, mass, centre of mass along and across the link, inertia about that.
LENGTH, MASS, ALONG, ACROSS, INERTIA = range(5)
#: Columns of `HiddenArm.drive`: gain factor, limit (0 for none), time constant, delay.
FACTOR, LIMIT, LAG_S, DELAY_S = range(4)
#: Columns of `HiddenArm.transmission`: gap, stiffness, damping; all zero where the joint is driven directly.
GAP, STIFFNESS, DAMPING = range(3)
#: What acts at a joint, as a number in `HiddenArm.acting`; those from 100 on are in no catalogue.
ACTIONS = {
    "coulomb_asymmetry": 1,
    "stribeck": 2,
    "load_friction": 3,
    "quadratic_drag": 4,
    "joint_spring": 5,
    "end_stop": 6,
    "cogging": 7,
    "torque_offset": 8,
    "thermal_drift": 9,
    "periodic_disturbance": 10,
    "external_push": 11,
    "air_drag": 12,
    "friction_by_place": 101,
    "friction_by_other_angle": 102,
    "coupled_drag": 103,
    "friction_by_other_speed": 104,
    "soft_wall": 105,
    "cubic_spring": 106,
}
#: How fast a motor without inertia crosses its play when nothing in the loop slows it.
PLAY_CROSSED_S = 0.003
#: Steps that a delay may take.
MEMORY = 1024


class HiddenArm(NamedTuple):
    """Everything that the simulation knows; joints count from 0.

    Attributes
    ----------
    links : (n, 5)
    gravity : (2,)
        In the plane of the arm [m/s^2].
    offset : (n,)
        By how much the link's angle exceeds the joint's [rad].
    rotor : (n,)
        Added to the diagonal of the mass matrix [kg m^2].
    friction : (n, 3)
        Viscous [N m s], Coulomb and static [N m].
    gains : (n, 2)
        kp and kv.
    drive : (n, 4)
    transmission : (n, 3)
    payload_kg : (n_trial,)
        At the tip, trial by trial.
    payload_since : (2,)
        Another mass, and the time from which on it is there.
    acting : (n_action, 6)
        Number in `ACTIONS`, joint, and four numbers.
    """

    links: Floats
    gravity: Floats
    offset: Floats
    rotor: Floats
    friction: Floats
    gains: Floats
    drive: Floats
    transmission: Floats
    payload_kg: Floats
    payload_since: Floats
    acting: Floats


class Recorded(NamedTuple):
    """What was simulated, without noise; every array but ``t`` is (n_sample, n).

    ``q`` and ``dq`` are what the controller sees and ``u`` what it asks for; ``link_q``, ``link_dq`` and
    ``link_ddq`` are the link's own, ``drive`` is the torque that reaches it.
    """

    t: Floats
    q: Floats
    dq: Floats
    u: Floats
    link_q: Floats
    link_dq: Floats
    link_ddq: Floats
    drive: Floats
    ref: Floats


kernel = numba.njit(cache=True, nogil=True, error_model="numpy")


@kernel
def mass_and_bias(links, gravity, offset, rotor, payload_kg, q, dq, M, bias, at):
    """Fill in the mass matrix and what gravity and the turning of the links ask for."""
    n = q.size
    for k in range(n):
        bias[k] = 0.0
        for j in range(n):
            M[k, j] = 0.0
    turn, speed, pull_x, pull_y = 0.0, 0.0, -gravity[0], -gravity[1]
    at[0, 0], at[0, 1] = 0.0, 0.0
    for i in range(n):
        turn += q[i] + offset[i]
        speed += dq[i]
        c, s, L = np.cos(turn), np.sin(turn), links[i, LENGTH]
        at[i + 1, 0], at[i + 1, 1] = at[i, 0] + L * c, at[i, 1] + L * s
        for body in range(1 if i < n - 1 or payload_kg == 0.0 else 2):
            m, along, across = links[i, MASS], links[i, ALONG], links[i, ACROSS]
            inertia = links[i, INERTIA]
            if body == 1:
                m, along, across, inertia = payload_kg, L, 0.0, 0.0
            rx, ry = c * along - s * across, s * along + c * across
            ax, ay = pull_x - speed * speed * rx, pull_y - speed * speed * ry
            for k in range(i + 1):
                kx, ky = -(at[i, 1] + ry - at[k, 1]), at[i, 0] + rx - at[k, 0]
                bias[k] += m * (kx * ax + ky * ay)
                for j in range(k + 1):
                    jx, jy = -(at[i, 1] + ry - at[j, 1]), at[i, 0] + rx - at[j, 0]
                    M[k, j] += m * (kx * jx + ky * jy) + inertia
        pull_x -= speed * speed * L * c
        pull_y -= speed * speed * L * s
    for k in range(n):
        M[k, k] += rotor[k]
        for j in range(k):
            M[j, k] = M[k, j]


@kernel
def invert(M, W):
    """Fill in the inverse of a small symmetric positive definite matrix by Gauss and Jordan."""
    n = M.shape[0]
    W[:] = M
    for p in range(n):
        pivot = 1.0 / W[p, p]
        W[p, p] = 1.0
        for j in range(n):
            W[p, j] *= pivot
        for i in range(n):
            if i != p:
                factor = W[i, p]
                W[i, p] = 0.0
                for j in range(n):
                    W[i, j] -= factor * W[p, j]


@kernel
def drive_stage(gains, path, transmission, ref, q, dq, x, lag, late, u, drive, dx):
    """Fill in what the controller asks for, what reaches the joint, and how the transmission yields.

    ``late`` is what the controller asked for before, where the torque comes late. Where there is no memory
    between the controller and the joint, the yielding is in its own feedback: that is solved for.
    """
    for i in range(q.size):
        kp, kv = gains[i, 0], gains[i, 1]
        factor, limit = path[i, FACTOR], path[i, LIMIT]
        asked = kp * (ref[i] - q[i] - x[i]) + kv * dq[i]
        remembers = path[i, DELAY_S] > 0.0 or path[i, LAG_S] > 0.0
        given = late[i] if path[i, DELAY_S] > 0.0 else asked
        given = factor * (lag[i] if path[i, LAG_S] > 0.0 else given)
        if limit > 0.0:
            given = min(max(given, -limit), limit)
        gap, k, d = transmission[i, GAP], transmission[i, STIFFNESS], transmission[i, DAMPING]
        dx[i] = 0.0
        if k > 0.0:
            dx[i] = (given - k * x[i]) / d
            if not remembers:
                dx[i] = (factor * asked - k * x[i]) / (d - factor * kv)
                given = factor * (asked + kv * dx[i])
                if limit > 0.0 and abs(given) > limit:
                    given = limit * np.sign(given)
                    dx[i] = (given - k * x[i]) / d
        elif gap > 0.0 and not (x[i] >= 0.5 * gap and given > 0.0 or x[i] <= -0.5 * gap and given < 0.0):
            dx[i] = np.sign(given) * gap / PLAY_CROSSED_S
            if not remembers and abs(asked) < abs(kv * dx[i]):
                dx[i] = -asked / kv
            given = 0.0
        u[i] = asked + kv * dx[i]
        drive[i] = given


@kernel
def feel(friction, acting, t, q, dq, drive, smooth, forwards, backwards):  # noqa: PLR0912 - one branch an effect
    """Fill in what resists at every joint: a torque, and friction when it moves forwards and backwards."""
    for i in range(q.size):
        smooth[i] = friction[i, 0] * dq[i]
        forwards[i], backwards[i] = friction[i, 1], 0.0
    for a in range(acting.shape[0]):
        kind, i = int(acting[a, 0]), int(acting[a, 1])
        p, r, s = acting[a, 2], acting[a, 3], acting[a, 4]
        if kind == 1:
            forwards[i] += p
            backwards[i] += 2.0 * p
        elif kind == 2:
            forwards[i] += p * np.exp(-((dq[i] / r) ** 2))
        elif kind == 3:
            forwards[i] += p * abs(drive[i])
        elif kind == 4:
            smooth[i] += p * dq[i] * abs(dq[i])
        elif kind == 5:
            smooth[i] += p * (q[i] - r)
        elif kind == 6:
            smooth[i] += r * (max(q[i] - p, 0.0) if s > 0.0 else min(q[i] - p, 0.0))
        elif kind == 7:
            smooth[i] -= p * np.sin(s * q[i] + r)
        elif kind == 8:
            smooth[i] -= p
        elif kind == 9:
            smooth[i] += p * max(t, 0.0) * friction[i, 0] * dq[i]
            forwards[i] += p * max(t, 0.0) * friction[i, 1]
        elif kind == 10:
            smooth[i] -= p * np.sin(2.0 * np.pi * r * t + s)
        elif kind == 11:
            smooth[i] -= s if p <= t <= p + r else 0.0
        elif kind == 12:
            turning = 0.0
            for k in range(i + 1):
                turning += dq[k]
            for k in range(i + 1):
                smooth[k] += p * turning * abs(turning)
        elif kind == 101:
            smooth[i] += p * np.sin(q[0]) * np.cos(q[int(r)]) * dq[i]
        elif kind == 102:
            smooth[i] += p * q[int(r)] * dq[i]
        elif kind == 103:
            smooth[i] += p * dq[int(r)]
        elif kind == 104:
            forwards[i] += p * abs(dq[int(r)])
        elif kind == 105:
            smooth[i] += p * np.tanh(q[i] / r)
        elif kind == 106:
            smooth[i] += p * q[i] ** 3
    for i in range(q.size):
        backwards[i] -= forwards[i]
        if (
            backwards[i] > forwards[i]
        ):  # it drives rather than resists, as some calibrations have it: it holds nothing
            smooth[i] += forwards[i] if dq[i] > 0.0 else (backwards[i] if dq[i] < 0.0 else 0.0)
            forwards[i], backwards[i] = 0.0, 0.0


@kernel
def rub(friction, h, W, before, v, forwards, backwards, held, room):  # noqa: PLR0912 - a small solver
    """Slow the joints down by friction: ``v`` goes from the velocity without it to that with it.

    ``held`` is the friction of the last step and becomes that of this one. A joint that was at rest is held up to
    its static friction; once that is not enough, by as much as when it moves.
    """
    n = v.size
    low, high, free = room[0], room[1], room[2]
    for i in range(n):
        low[i], high[i], free[i] = backwards[i], forwards[i], v[i]
        if before[i] == 0.0:
            high[i] = max(high[i], friction[i, 2])
            low[i] = min(low[i], -friction[i, 2])
    for _ in range(n + 1):
        for i in range(n):
            held[i] = min(max(held[i], low[i]), high[i])
            v[i] = free[i]
        for i in range(n):
            for j in range(n):
                v[i] -= h * W[i, j] * held[j]
        for _ in range(300):
            most = 0.0
            for i in range(n):
                was = held[i]
                held[i] = min(max(was + v[i] / (h * W[i, i]), low[i]), high[i])
                if held[i] != was:
                    for j in range(n):
                        v[j] -= h * W[j, i] * (held[i] - was)
                    most = max(most, abs(held[i] - was) * W[i, i])
            if most < 1e-4:
                break
        broken = False
        for i in range(n):
            inside = low[i] < held[i] < high[i]
            if inside:
                v[i] = 0.0
            elif before[i] == 0.0 and (high[i] > forwards[i] or low[i] < backwards[i]):
                high[i], low[i], broken = forwards[i], backwards[i], True
        if not broken:
            return


@kernel
def accelerate(W, drive, smooth, bias, a):
    """Fill in the accelerations but for friction."""
    for i in range(a.size):
        a[i] = 0.0
        for j in range(a.size):
            a[i] += W[i, j] * (drive[j] - smooth[j] - bias[j])


@kernel
def heun(  # noqa: PLR0912, PLR0915 - the state is many small arrays, none of which may be allocated in the loop
    links,
    gravity,
    offset,
    rotor,
    friction,
    gains,
    path,
    transmission,
    payload_kg,
    payload_since,
    acting,
    late_steps,
    h,
    every,
    lead,
    ref,
    trial_steps,
    q0,
):
    """Simulate from rest at ``q0``, with ``lead`` steps before t = 0; see `simulate`."""
    n, n_sample = q0.size, ref.shape[0]
    out = np.empty((n_sample, 7, n))
    q, dq, x, lag = q0.copy(), np.zeros(n), np.zeros(n), np.zeros(n)
    q2, dq2, x2, lag2 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    M, W, V = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    bias, smooth, dx, dx2 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    u, drive, u2, drive2 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    high, low, high2, low2 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    a, a2, v, held, late = np.empty(n), np.empty(n), np.empty(n), np.zeros(n), np.zeros(n)
    at, room = np.empty((n + 1, 2)), np.empty((3, n))
    at_step, before_step = np.zeros((MEMORY, n)), np.zeros((MEMORY, n))
    for k in range(lead + (n_sample - 1) * every + 1):
        t, step = (k - lead) * h, max(k - lead, 0)
        target = ref[step // every]
        payload = payload_kg[step // trial_steps]
        if t >= payload_since[1]:
            payload += payload_since[0]
        for i in range(n):
            late[i] = at_step[(k - late_steps[i]) % MEMORY, i]
        drive_stage(gains, path, transmission, target, q, dq, x, lag, late, u, drive, dx)
        for i in range(n):
            at_step[k % MEMORY, i] = u[i]
        feel(friction, acting, t, q, dq, drive, smooth, high, low)
        mass_and_bias(links, gravity, offset, rotor, payload, q, dq, M, bias, at)
        invert(M, W)
        accelerate(W, drive, smooth, bias, a)
        for i in range(n):
            v[i] = dq[i] + h * a[i]
        rub(friction, h, W, dq, v, high, low, held, room)
        for i in range(n):
            dq2[i], q2[i], x2[i] = v[i], q[i] + h * dq[i], x[i] + h * dx[i]
            if path[i, LAG_S] > 0.0:
                given = late[i] if path[i, DELAY_S] > 0.0 else u[i]
                lag2[i] = lag[i] + h * (given - lag[i]) / path[i, LAG_S]
            late[i] = before_step[(k + 1 - late_steps[i]) % MEMORY, i]
        if k >= lead and (k - lead) % every == 0:
            row = out[(k - lead) // every]
            for i in range(n):
                row[0, i], row[1, i], row[2, i] = q[i] + x[i], dq[i] + dx[i], u[i]
                row[3, i], row[4, i], row[5, i], row[6, i] = q[i], dq[i], (v[i] - dq[i]) / h, drive[i]
        drive_stage(gains, path, transmission, target, q2, dq2, x2, lag2, late, u2, drive2, dx2)
        for i in range(n):
            before_step[(k + 1) % MEMORY, i] = u2[i]
        feel(friction, acting, t + h, q2, dq2, drive2, smooth, high2, low2)
        mass_and_bias(links, gravity, offset, rotor, payload, q2, dq2, M, bias, at)
        invert(M, V)
        accelerate(V, drive2, smooth, bias, a2)
        for i in range(n):
            v[i] = dq[i] + 0.5 * h * (a[i] + a2[i])
            high[i], low[i] = 0.5 * (high[i] + high2[i]), 0.5 * (low[i] + low2[i])
            for j in range(n):
                W[i, j] = 0.5 * (W[i, j] + V[i, j])
        rub(friction, h, W, dq, v, high, low, held, room)
        for i in range(n):
            q[i] += 0.5 * h * (dq[i] + v[i])
            x[i] += 0.5 * h * (dx[i] + dx2[i])
            if transmission[i, GAP] > 0.0:
                half = 0.5 * transmission[i, GAP]
                x[i] = min(max(x[i], -half), half)
            if path[i, LAG_S] > 0.0:
                given = late[i] if path[i, DELAY_S] > 0.0 else u2[i]
                lag[i] = 0.5 * (lag[i] + lag2[i] + h * (given - lag2[i]) / path[i, LAG_S])
            dq[i] = v[i]
    return out


def simulate(
    arm: HiddenArm,
    ref: Floats,
    rate_hz: float,
    trial_s: float,
    step_hz: float = 8000.0,
    lead_s: float = 6.0,
    q0: Floats | None = None,
) -> Recorded:
    """Simulate an arm under its control.

    Parameters
    ----------
    arm : HiddenArm
    ref : (n_sample, n)
        Target, held from one sample to the next [rad].
    rate_hz : float
        Of the samples.
    trial_s : float
        How long a trial is; only the payload asks.
    step_hz : float
        A multiple of ``rate_hz``. Delays are rounded to such steps, and shorter than `MEMORY` of them.
    lead_s : float
        For so long before t = 0 the first target is held.
    q0 : (n,), optional
        Where it begins, at rest; the first target unless given.

    Returns
    -------
    Recorded
    """
    every = round(step_hz / rate_hz)
    h = 1.0 / (every * rate_hz)
    start = ref[0] if q0 is None else q0
    out = heun(
        *arm,
        np.maximum(np.rint(arm.drive[:, DELAY_S] / h), 1.0).astype(np.int64),
        h,
        every,
        round(lead_s / h),
        np.ascontiguousarray(ref, dtype=np.float64),
        round(trial_s / h),
        np.array(start, dtype=np.float64),
    )
    return Recorded(np.arange(len(ref)) / rate_hz, *(out[:, k] for k in range(7)), ref)
