"""A person of the table, and what the ground does to it."""

from dataclasses import replace

import numpy as np

from arm.body.whole_body import human_body
from arm.model import Arm, Body, Floats
from arm.moving_base import standing_base
from fitter.data.derivatives import both_derivatives, lowpass
from fitter.ground.clock_shift import ClockShift
from fitter.ground.deformation import Deformation
from fitter.ground.disturbances import postures
from fitter.ground.floating_base import FloatingBase, base_regressor, floating_base
from fitter.ground.ground_trial import GroundTrial
from fitter.ground.link_motion import link_motions

DT = 0.01


PERSON = human_body(Body("human-body", 70.0, 1.75, "m"))
BASE = floating_base(PERSON)


def other_masses(base: FloatingBase, rng: np.random.Generator) -> Floats:
    """Return standard parameters of a person who differs from the table by some 20 %."""
    std = np.array([0.2, *[0.25] * 3, *[0.1] * 6])
    return Deformation(base.links).parameters((rng.normal(size=(len(base.bodies), 10)) * std).ravel())


def weighing(person: Arm, theta: Floats) -> Arm:
    """Return the person with the mass that a scale shows."""
    assert person.body is not None
    return replace(person, body=replace(person.body, mass_kg=float(theta[9::10].sum())))


def moving(person: Arm, rng: np.random.Generator, seconds: float, size: float = 0.3) -> Floats:
    """Joint positions of somebody who moves about slowly."""
    n = round(seconds / DT)
    q = lowpass(rng.normal(size=(n, person.n_joint)), DT, 0.6)
    return np.asarray(size * q / q.std(axis=0) * np.array([0.15] * 3 + [0.5] * 3 + [1.0] * (person.n_joint - 6)))


def trial_of(
    person: Arm, base: FloatingBase, q: Floats, seen: Floats, theta: Floats, noise: Floats
) -> GroundTrial:
    """Return a trial with the ground's force of one motion and the joints of another, as seen."""
    dq, ddq = both_derivatives(q, DT)
    true = link_motions(person, q, dq, ddq, standing_base(len(q)))
    wrench = base_regressor([true[i] for i in base.bodies]) @ theta + noise
    dq, ddq = both_derivatives(seen, DT)
    motions = link_motions(person, seen, dq, ddq, standing_base(len(q)))
    about = true[base.bodies[0]].o - motions[base.bodies[0]].o
    wrench[:, 3:] += np.cross(about, wrench[:, :3])
    Y = base_regressor([motions[i] for i in base.bodies])
    inner, t = slice(50, -50), np.arange(len(q)) * DT

    def inside(one):
        return replace(one, **{name: getattr(one, name)[inner] for name in one.__dataclass_fields__})

    return GroundTrial(
        "moves",
        t[inner],
        DT,
        [inside(motion) for motion in motions],
        [inside(posture) for posture in postures(person, base, motions, seen, dq, ddq)],
        Y[inner],
        wrench[inner],
        ClockShift(0.0, 0.0),
        (),
        np.zeros(3),
        (),
    )
