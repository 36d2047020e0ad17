"""What moves a hidden arm and what resists, by nobody else's code.

Lagrange's equations with the mass matrix from the Jacobians of the links' centres, and friction as an impulse at
the end of each step that is as large as it may be and no larger than it must be to stop the joint (projected
Gauss-Seidel): a joint sticks where friction can hold it. The drive, the transmission and what the joints feel are
written out from the definitions of the effects, not taken from their catalogue.
"""

import numba
import numpy as np

from benchmarks.hidden_arms.hidden_arm import (
    ACROSS,
    ALONG,
    DAMPING,
    DELAY_S,
    FACTOR,
    GAP,
    INERTIA,
    LAG_S,
    LENGTH,
    LIMIT,
    MASS,
    PLAY_CROSSED_S,
    STIFFNESS,
)

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
