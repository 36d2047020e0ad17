"""Torque files of arms that nobody has seen: arm, motion, noise and rate are drawn by seed."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from arm.model import STANDARD_GRAVITY_M_S2, Arm, Control, Floats, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics, mass_matrix
from arm.simulation import simulate

#: Kinds of file: angles alone, or velocities and accelerations beside them.
GIVEN = ("q", "dq,ddq")
#: Kinds of motion.
MOVED = ("fourier", "points", "driven")
#: Rates that are drawn for short chains, and for long ones, whose columns are many [Hz].
_RATES_HZ, _LONG_RATES_HZ = (100.0, 250.0, 500.0, 1000.0), (100.0, 250.0)
#: Number of joints up to which a chain is short.
_SHORT = 3
#: White noise or step of an encoder [rad], and noise of a torque as a share of its rms.
_ANGLE_NOISE, _TORQUE_NOISE = (1e-5, 1e-3), (1e-3, 5e-2)
#: Correlation time of a coloured torque noise [s].
_COLOUR_S = (0.005, 0.1)
#: Kinds of torque noise: white, coloured, or white in proportion to the torque at that instant.
_TORQUES = ("white", "coloured", "proportional")
#: A driven arm is simulated at this rate and a control law stiff enough to follow [1/s^2, 1/s].
_SIMULATED_HZ, _STIFFNESS, _DAMPING = 2000.0, 60.0, 12.0
#: Static friction as a multiple of Coulomb's.
_STATIC = 1.3
#: Noise of velocities and accelerations that are given, as a share of their rms: those of a good tracker.
_GIVEN_NOISE = 1e-3


@dataclass(frozen=True)
class Case:
    """One arm and its files.

    Attributes
    ----------
    seed : int
    arm : Arm
        With its true masses and frictions.
    given, moved, encoder, torque, derived : str
        Kind of file, motion, angle noise ("white" or "steps") and torque noise; derivatives that are given are a
        good tracker's ("tracked"), or differences of the noisy angles ("differences").
    rate_hz, angle_rad, torque_share : float
        Rate, size of the angle noise, and torque noise as a share of the torque's rms.
    trials : tuple of dict
        Columns of each file.
    """

    seed: int
    arm: Arm
    given: str
    moved: str
    encoder: str
    torque: str
    derived: str
    rate_hz: float
    angle_rad: float
    torque_share: float
    trials: tuple[dict[str, Floats], ...]


def draw_arm(rng: np.random.Generator, n_joint: int) -> Arm:
    """Return an arm of any geometry whose links could exist."""
    joints = []
    square = rng.random() < 0.5  # axes are parallel or square in most machines
    for _ in range(n_joint):
        alpha = rng.choice([0.0, np.pi / 2, -np.pi / 2]) if square else rng.uniform(-1.6, 1.6)
        mass = rng.uniform(0.5, 5.0)
        com = rng.uniform(-0.15, 0.25, 3)
        box = rng.uniform(0.03, 0.25, 3)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        about_com = mass / 3.0 * turn @ np.diag((box**2).sum() - box**2) @ turn.T
        whole = about_com + mass * (com @ com * np.eye(3) - np.outer(com, com))
        inertia = tuple(float(whole[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        viscous, coulomb = (float(10.0 ** rng.uniform(-1.5, 0.3)) for _ in range(2))
        friction = Friction(viscous, coulomb, _STATIC * coulomb)
        x, y, z = map(float, com)
        link = Link(float(mass), (x, y, z), inertia)  # type: ignore[arg-type]
        joints.append(
            Joint(
                alpha_rad=float(alpha),
                a_m=float(rng.uniform(0.0, 0.5)),
                d_m=float(rng.uniform(0.0, 0.3)),
                friction=friction,
                link=link,
            )
        )
    down = rng.normal(size=3)
    if rng.random() < 0.5:
        down = np.eye(3)[rng.integers(3)]
    gx, gy, gz = (float(g) for g in STANDARD_GRAVITY_M_S2 * down / np.linalg.norm(down))
    return Arm("drawn", tuple(joints), (gx, gy, gz))


def fourier(rng: np.random.Generator, n_joint: int, t: Floats) -> tuple[Floats, Floats, Floats]:
    """Return q, dq, ddq of a periodic motion, (n, n_joint) each."""
    base = 2.0 * np.pi * rng.uniform(0.08, 0.2)
    q, dq, ddq = (np.zeros((len(t), n_joint)) for _ in range(3))
    for k in range(1, int(rng.integers(3, 7)) + 1):
        size, phase = rng.normal(size=n_joint) * 0.6 / np.sqrt(k), rng.uniform(0.0, 2.0 * np.pi, n_joint)
        angle = k * base * t[:, None] + phase
        q += size * np.sin(angle)
        dq += size * k * base * np.cos(angle)
        ddq -= size * (k * base) ** 2 * np.sin(angle)
    return q, dq, ddq


def points(rng: np.random.Generator, n_joint: int, t: Floats) -> tuple[Floats, Floats, Floats]:
    """Return q, dq, ddq of a motion from point to point, each way of least jerk, with rests between them."""
    q, dq, ddq = (np.zeros((len(t), n_joint)) for _ in range(3))
    at, begin = rng.uniform(-1.5, 1.5, n_joint), 0.0
    rest_s = rng.uniform(0.0, 0.5)
    while begin < t[-1]:
        goal, lasts = rng.uniform(-1.5, 1.5, n_joint), rng.uniform(0.8, 2.0)
        s = np.clip((t - begin) / lasts, 0.0, 1.0)[:, None]
        now = t >= begin
        way = goal - at
        q[now] = (at + way * (10 * s**3 - 15 * s**4 + 6 * s**5))[now]
        dq[now] = (way / lasts * (30 * s**2 - 60 * s**3 + 30 * s**4))[now]
        ddq[now] = (way / lasts**2 * (60 * s - 180 * s**2 + 120 * s**3))[now]
        at, begin = goal, begin + lasts + rest_s
    return q, dq, ddq


def driven(rng: np.random.Generator, arm: Arm, t: Floats, tracked: bool) -> tuple[Floats, Floats, Floats, Floats]:
    """Return q, dq, ddq, tau of an arm that sticks and slides on its way to targets that jump."""
    step = 1.0 / _SIMULATED_HZ
    n = round((t[-1] + t[1] - t[0]) * _SIMULATED_HZ)
    goals = np.zeros((n, arm.n_joint))
    begin = 0
    while begin < n:
        goals[begin:] = rng.uniform(-1.2, 1.2, arm.n_joint)
        begin += round(rng.uniform(0.7, 2.0) * _SIMULATED_HZ)
    at = goals[0]
    inertia = np.diag(mass_matrix(arm, at[None])[0])
    law = Control("pd", tuple((_STIFFNESS * inertia).tolist()), tuple((-_DAMPING * inertia).tolist()))
    # a target that is passed through a filter, as controllers do
    keep = np.exp(-step / 0.1)
    goals = lfilter([(1.0 - keep) ** 2], [1.0, -2.0 * keep, keep**2], goals - at, axis=0) + at
    motion = simulate(replace(arm, control=law), goals, step, at)
    tau = motion.tau
    if not tracked:
        # Between two steps the target is held: as seen by the angles it comes half a step late. The acceleration
        # of a step is that of its own target.
        tau = tau - 0.5 * np.array(law.kp) * np.diff(goals, axis=0, prepend=goals[:1])
    pick = np.round(t * _SIMULATED_HZ).astype(np.intp)
    return motion.q[pick], motion.dq[pick], motion.ddq[pick], tau[pick]


def coloured(rng: np.random.Generator, shape: tuple[int, int], dt_s: float, correlated_s: float) -> Floats:
    """Return noise of variance one whose correlation falls to 1/e in some time; white for 0 s."""
    noise = rng.normal(size=shape)
    if correlated_s <= 0.0:
        return noise
    keep = np.exp(-dt_s / correlated_s)
    for k in range(1, len(noise)):
        noise[k] = keep * noise[k - 1] + np.sqrt(1.0 - keep**2) * noise[k]
    return noise


def draw_case(seed: int, n_joint: int, given: str, repeat: int = 0) -> Case:
    """Draw an arm, how it moves, and what is measured of it; a repeat has nothing but noise of its own."""
    rng = np.random.default_rng([seed, n_joint, GIVEN.index(given)])
    chance = np.random.default_rng([seed, n_joint, GIVEN.index(given), repeat])
    arm = draw_arm(rng, n_joint)
    rate_hz = float(rng.choice(_RATES_HZ if n_joint <= _SHORT else _LONG_RATES_HZ))
    sizes = (_ANGLE_NOISE, _TORQUE_NOISE)
    angle_rad, torque_share = (float(np.exp(rng.uniform(*np.log(size)))) for size in sizes)
    encoder, torque = str(rng.choice(["white", "steps"])), str(rng.choice(_TORQUES))
    moved, derived = str(rng.choice(MOVED)), str(rng.choice(["tracked", "differences"]))
    colour_s = float(np.exp(rng.uniform(*np.log(_COLOUR_S)))) if torque == "coloured" else 0.0
    parts, whole_s = int(rng.choice([1, 1, 2, 4])), float(rng.uniform(10.0, 30.0) if n_joint <= _SHORT else 30.0)
    t = np.arange(round(whole_s / parts * rate_hz)) / rate_hz
    trials = []
    for _ in range(parts):
        if moved == "driven":
            q, dq, ddq, tau = driven(rng, arm, t, (given, derived) == ("dq,ddq", "tracked"))
        else:
            q, dq, ddq = (fourier if moved == "fourier" else points)(rng, n_joint, t)
            tau = inverse_dynamics(arm, q, dq, ddq)
        size = torque_share * np.sqrt(np.mean(tau**2, axis=0))
        if torque == "proportional":
            size = torque_share * np.abs(tau)
        tau = tau + size * coloured(chance, tau.shape, 1.0 / rate_hz, colour_s)
        if encoder == "white":
            q = q + angle_rad * chance.normal(size=q.shape)
        else:
            q = angle_rad * np.round(q / angle_rad)
        columns = {"q": q, "tau": tau}
        if given == "dq,ddq" and derived == "differences":
            columns["dq"] = np.gradient(q, 1.0 / rate_hz, axis=0)
            columns["ddq"] = np.gradient(columns["dq"], 1.0 / rate_hz, axis=0)
        elif given == "dq,ddq":
            for name, values in (("dq", dq), ("ddq", ddq)):
                noise = _GIVEN_NOISE * np.sqrt(np.mean(values**2, axis=0))
                columns[name] = values + noise * chance.normal(size=values.shape)
        trials.append({"t": t, **columns})
    return Case(seed, arm, given, moved, encoder, torque, derived, rate_hz, angle_rad, torque_share, tuple(trials))


def write_case(case: Case, folder: Path) -> list[Path]:
    """Write the files of a case, the first trial as CSV and the others as NPZ; return their paths."""
    paths = []
    for number, trial in enumerate(case.trials):
        flat = {"t": trial["t"]}
        for name, values in trial.items():
            flat |= {} if name == "t" else {f"{name}{j + 1}": values[:, j] for j in range(values.shape[1])}
        path = folder / f"trial{number}{'.npz' if number else '.csv'}"
        if number:
            np.savez(path, **flat)  # type: ignore[arg-type]
        else:
            table = np.column_stack(list(flat.values()))
            np.savetxt(path, table, "%.10g", ",", header=",".join(flat), comments="")
        paths.append(path)
    return paths
