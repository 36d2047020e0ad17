"""An arm with something hidden in it: planar links under a PD law, and what a simulation of it records."""

from typing import NamedTuple

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
