"""A small driven arm with a hidden friction, as torques and angles are measured of it."""

import numpy as np

from arm.model import Arm, Control, Effect, Friction, Joint, Link
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import to_trials

STEP_S = 2e-3
LINK = Link(0.5, (0.1, 0.0, 0.0), (0.0, 0.0, 0.008, 0.0, 0.0, 0.0))
#: Two links that hang; their elbow has a rotor that none of the links carries.
TRUE = Arm(
    "hanging",
    tuple(Joint(a_m=0.2, friction=Friction(0.01, 0.02), link=LINK) for _ in range(2)),
    gravity_m_s2=(9.81, 0.0, 0.0),
    effects=(Effect("rotor_inertia", {"inertia_kg_m2": 0.004}, joints=(2,)),),
    control=Control(),
)


def driven_trials(arm: Arm, n_trial: int, noise: float = 0.0) -> list[Trial]:
    """Return trials of torques that swing an arm about, 3 s each."""
    rng, t = np.random.default_rng(0), STEP_S * np.arange(1501)
    measured = []
    for k in range(n_trial):
        torque = np.column_stack([0.6 * np.sin(2 * np.pi * (0.7 + 0.3 * k) * t), 0.3 * np.sin(8.0 * t + k)])
        q = simulate(arm, torque, STEP_S, np.zeros(2), torque=torque).q
        columns = {"q": q + noise * rng.normal(size=q.shape), "tau": torque}
        measured.append(Measured(f"trial#{k}", "here", 0, t, columns))
    return to_trials(measured)
