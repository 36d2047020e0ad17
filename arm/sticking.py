"""Static friction: which joints stick, which let go, and when that changes.

A joint is in one of three modes: sliding forwards (1), sliding backwards (-1) or stuck (0). Within a mode the
equations are smooth. A stuck joint is held until what pulls at it exceeds its static (or Coulomb) friction.
"""

import numpy as np

from arm.model import Floats
from arm.motion_equations import acceleration
from arm.room import Room
from limbcal.compiled import compiled, inlined


@inlined
def pull_at(i: int, room: Room, ddq: Floats) -> float:
    """Return what pulls at a joint beside what its own acceleration takes."""
    pull = room.net[i]
    for j in range(ddq.size):
        pull -= room.M[i, j] * ddq[j]
    return float(pull)


@inlined
def pull_beyond(i: int, room: Room, ddq: Floats) -> float:
    """Return by how much what pulls at a stuck joint exceeds what can hold it, signed as the pull; 0 if held."""
    pull = pull_at(i, room, ddq)
    return float(np.sign(pull) * max(abs(pull) - room.hold[i], 0.0))


@inlined
def slack_of(i: int, mode: Floats, dq: Floats, room: Room, ddq: Floats) -> float:
    """Return how far a joint is from the end of its mode, by its velocity or its hold; negative beyond."""
    if mode[i] != 0.0:
        return mode[i] * dq[i] if room.directed[i] else 1.0
    return float(room.hold[i] - abs(pull_at(i, room, ddq)))


@compiled
def choose_modes(dq: Floats, mode: Floats, room: Room, ddq: Floats) -> None:
    """Say which resting joints stick: those whose friction can hold them. The equations must be set up.

    The accelerations minimise ``ddq.M ddq / 2 - net.ddq + coulomb.|ddq|``; joints are let go one by one as
    in Lawson and Hanson's active sets, and held again where one would move against its own friction.
    ``ddq`` is room to work in.
    """
    n = dq.size
    resting = False
    for i in range(n):
        mode[i] = np.sign(dq[i])
        if dq[i] == 0.0 and not room.directed[i]:
            mode[i] = 1.0  # nothing to hold it, and nothing that changes with its direction
        resting = resting or mode[i] == 0.0
    if not resting:
        return
    reached = room.bias
    acceleration(mode, room, reached)
    for _ in range(8 * n):  # more than it ever takes, but a law may make M indefinite
        most, first = 0.0, -1
        for i in range(n):
            if mode[i] == 0.0:
                excess = pull_beyond(i, room, reached)
                if abs(excess) > abs(most):
                    most, first = excess, i
        if first < 0:
            return
        mode[first] = np.sign(most)  # the one that friction holds least goes first: it may relieve others
        hold_again(dq, mode, room, reached, ddq)


@compiled
def hold_again(dq: Floats, mode: Floats, room: Room, reached: Floats, ddq: Floats) -> None:
    """Go from the accelerations ``reached`` to those of the modes, holding each joint that would turn round."""
    for _ in range(dq.size):
        acceleration(mode, room, ddq)
        against, share = -1, 1.0
        for i in range(dq.size):
            if dq[i] == 0.0 and mode[i] * ddq[i] < 0.0 and room.directed[i]:
                part = reached[i] / (reached[i] - ddq[i])
                if part < share:
                    against, share = i, part
        for i in range(dq.size):
            reached[i] += share * (ddq[i] - reached[i])
        if against < 0:
            return
        mode[against], reached[against] = 0.0, 0.0


@inlined
def reversed_joint(i: int, mode: Floats, dq: Floats, room: Room) -> bool:
    """Say whether a joint moves against its mode: it has come to rest before."""
    return bool(mode[i] * dq[i] < 0.0 and room.directed[i])


@compiled
def stop_reversed(mode: Floats, dq: Floats, room: Room) -> None:
    """Bring to rest the joints that move against their modes."""
    for i in range(dq.size):
        if reversed_joint(i, mode, dq, room):
            dq[i] = 0.0
