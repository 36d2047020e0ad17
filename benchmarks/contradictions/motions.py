"""Arms, motions with the torque that they take, and what can be wrong with them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.model import Arm, Control, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics

Floats = NDArray[np.float64]
Columns = dict[str, Floats]

RATE_HZ, SECONDS, NOISE = 250.0, 6.0, 0.01


def arms() -> list[Arm]:
    """Return arms of one, two and three joints with gravity, torque measured."""
    rng = np.random.default_rng(7)
    two = replace(load_arm("dd-arm-vertical"), control=Control(), name="two")
    joint = Joint("revolute", 0.0, 0.4, 0.0, 0.0, 0.0, friction=Friction(0.2, 0.1, 0.0), link=_rod(2.0, 0.4))
    one = Arm("one", (joint,), (0.0, -9.80665, 0.0), control=Control())
    three = Arm(
        "three",
        tuple(
            Joint(
                "revolute",
                alpha,
                a,
                d,
                0.0,
                0.0,
                friction=Friction(*rng.uniform(0.05, 0.3, 2).tolist(), 0.0),
                link=_rod(m, 0.3),
            )
            for alpha, a, d, m in ((0.0, 0.0, 0.2, 3.0), (np.pi / 2, 0.3, 0.0, 2.0), (0.0, 0.25, 0.0, 1.0))
        ),
        (0.0, 0.0, -9.80665),
        control=Control(),
    )
    return [one, two, three]


def _rod(mass: float, length: float) -> Link:
    slim, long = 0.002 * mass, mass * length**2 / 3 + 0.001 * mass
    return Link(mass, (length / 2, 0.01, 0.005), (slim, long, long, 0.0, 0.0, 0.0))


def motion(arm: Arm, seed: int, size: float = 1.0) -> Columns:
    """Return a motion of three sines a joint with tip and torque, and 1 % of noise in the torque."""
    rng, n = np.random.default_rng(seed), arm.n_joint
    t = np.arange(0.0, SECONDS, 1.0 / RATE_HZ)
    amplitude, pulse, phase = (rng.uniform(*span, (3, 1, n)) for span in ((0.2, 0.6), (1.0, 7.0), (0.0, 6.28)))
    angle = pulse * t[:, None] + phase
    q = size * (amplitude * np.sin(angle)).sum(0)
    dq = size * (amplitude * pulse * np.cos(angle)).sum(0)
    ddq = -size * (amplitude * pulse**2 * np.sin(angle)).sum(0)
    tau = inverse_dynamics(arm, q, dq, ddq)
    tip = tip_position(replace(arm, tip=None), q)
    return {
        "t": t,
        "q": q + 1e-5 * rng.normal(size=q.shape),
        "dq": dq,
        "ddq": ddq,
        "tau": tau + NOISE * np.std(tau, axis=0) * rng.normal(size=tau.shape),
        "tip": tip + 2e-4 * rng.normal(size=tip.shape),
    }


def changed(columns: Columns, **others: Floats) -> Columns:
    """Return columns with some of them others."""
    return {**columns, **others}


def wrapped(angle: Floats) -> Floats:
    """Return an angle between −π and π."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def frozen(columns: Columns, joint: int, at: int, length: int) -> Columns:
    """Return columns in which an encoder stands still for a while."""
    q = columns["q"].copy()
    q[at : at + length, joint] = q[at, joint]
    return changed(columns, q=q)


def delayed(columns: Columns, samples: int) -> Columns:
    """Return columns whose torque comes some samples late."""
    return changed(columns, tau=np.roll(columns["tau"], samples, axis=0))


def upside_down(arm: Arm) -> Arm:
    """Return the arm with gravity the other way."""
    x, y, z = arm.gravity_m_s2
    return replace(arm, gravity_m_s2=(-x, -y, -z))


def reaching(arm: Arm) -> Arm:
    """Return the arm whose tip is the last frame's origin."""
    return replace(arm, tip=None)


def with_tip(arm: Arm, columns: Columns, q: Floats | None = None) -> Columns:
    """Return columns with the tip that belongs to other angles; as they are without these."""
    if q is None:
        return columns
    return changed(columns, tip=tip_position(replace(arm, tip=None), q))


def readings(arm: Arm, seed: int) -> tuple[Floats, Floats]:
    """Return accelerations of a motion between two rests, at 500 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 4.0, 2e-3)
    s = np.clip((t - 1.0) / 1.5, 0.0, 1.0)
    shape = 10 * s**3 - 15 * s**4 + 6 * s**5
    speed, bend = np.gradient(shape, t), np.gradient(np.gradient(shape, t), t)
    way = rng.uniform(0.4, 1.0, arm.n_joint)
    force = specific_force(arm, np.outer(shape, way), np.outer(speed, way), np.outer(bend, way))
    a = force.reshape(len(t), -1)
    return t, a + 0.02 * rng.normal(size=a.shape)
