"""A hidden arm simulated by Heun's step, which is nobody else's."""

import numpy as np

from benchmarks.hidden_arms.forces import drive_stage, feel, invert, kernel, mass_and_bias, rub
from benchmarks.hidden_arms.hidden_arm import DELAY_S, GAP, LAG_S, MEMORY, Floats, HiddenArm, Recorded


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
