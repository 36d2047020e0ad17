"""Static friction: which joints stick, which let go, and when that changes.

A joint is in one of three modes: sliding forwards (1), sliding backwards (-1) or stuck (0). Within a mode the
equations are smooth. A stuck joint is held until what pulls at it exceeds its static (or Coulomb) friction.
"""

import numpy as np

from arm.chain import Chain
from arm.model import Floats
from arm.motion_equations import Room, acceleration
from limbcal.compiled import compiled


@compiled
def directed(chain: Chain, i: int) -> bool:
    """Say whether the equations change with the direction in which a joint moves."""
    return bool(chain.friction[i, 1] != 0.0 or chain.friction[i, 2] > 0.0)


@compiled
def pull_beyond(chain: Chain, i: int, room: Room, ddq: Floats) -> float:
    """Return by how much what pulls at a stuck joint exceeds what can hold it, signed as the pull; 0 if held."""
    pull = room.net[i]
    for j in range(ddq.size):
        pull -= room.M[i, j] * ddq[j]
    hold = max(chain.friction[i, 2], chain.friction[i, 1], 0.0)
    return float(np.sign(pull) * max(abs(pull) - hold, 0.0))


@compiled
def choose_modes(chain: Chain, dq: Floats, mode: Floats, room: Room, ddq: Floats) -> None:
    """Say which resting joints stick: those whose friction can hold them. The equations must be set up.

    The accelerations minimise ``ddq.M ddq / 2 - net.ddq + coulomb.|ddq|``; joints are let go one by one as
    in Lawson and Hanson's active sets, and held again where one would move against its own friction.
    ``ddq`` is room to work in.
    """
    n = dq.size
    resting = False
    for i in range(n):
        mode[i] = np.sign(dq[i])
        if dq[i] == 0.0 and not directed(chain, i):
            mode[i] = 1.0  # nothing to hold it, and nothing that changes with its direction
        resting = resting or mode[i] == 0.0
    if not resting:
        return
    reached = room.bias
    acceleration(chain, mode, room, reached)
    for _ in range(8 * n):  # more than it ever takes, but a law may make M indefinite
        most, first = 0.0, -1
        for i in range(n):
            if mode[i] == 0.0:
                excess = pull_beyond(chain, i, room, reached)
                if abs(excess) > abs(most):
                    most, first = excess, i
        if first < 0:
            return
        mode[first] = np.sign(most)  # the one that friction holds least goes first: it may relieve others
        hold_again(chain, dq, mode, room, reached, ddq)


@compiled
def hold_again(chain: Chain, dq: Floats, mode: Floats, room: Room, reached: Floats, ddq: Floats) -> None:
    """Go from the accelerations ``reached`` to those of the modes, holding each joint that would turn round."""
    for _ in range(dq.size):
        acceleration(chain, mode, room, ddq)
        against, share = -1, 1.0
        for i in range(dq.size):
            if dq[i] == 0.0 and mode[i] * ddq[i] < 0.0 and directed(chain, i):
                part = reached[i] / (reached[i] - ddq[i])
                if part < share:
                    against, share = i, part
        for i in range(dq.size):
            reached[i] += share * (ddq[i] - reached[i])
        if against < 0:
            return
        mode[against], reached[against] = 0.0, 0.0


@compiled
def reversed_joint(chain: Chain, i: int, mode: Floats, dq: Floats) -> bool:
    """Say whether a joint moves against its mode: it has come to rest before."""
    return bool(mode[i] * dq[i] < 0.0 and directed(chain, i))
