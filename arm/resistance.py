"""With how much a joint resists, as its friction and its effects have it at an instant."""

from arm.chain import Chain
from arm.drive import GUESS, SHARE, TORQUE, Commands
from arm.effects.effect_table import EffectTable
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, TAU, VISCOUS, Q, T, torque_at
from arm.model import Floats
from arm.room import Room
from limbcal.compiled import compiled, inlined


@inlined
def resist(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    t: float,
    q: Floats,
    dq: Floats,
    mode: Floats,
    room: Room,
) -> None:
    """Take the effects that act at joints off ``net``, and say what friction is at this instant.

    What a sliding joint has is known. For one at rest that may go either way (its ``mode`` is 0) an effect counts
    as its mean, and half the difference between forwards and backwards joins the friction: the joint is held by so
    much more, about another centre.
    """
    x = room.seen
    x[T] = t
    for i in range(q.size):
        room.slip[i] = chain.friction[i, 1]
    for e in range(effects.joint.size):
        i = effects.joint[e]
        x[Q], x[DQ], x[DIRECTION] = q[i], dq[i], mode[i]
        x[TAU] = (
            room.way.state[TORQUE, i] + room.way.state[SHARE, i] * commands.law[2, i] * room.way.state[GUESS, i]
        )
        x[VISCOUS], x[COULOMB] = chain.friction[i, 0], chain.friction[i, 1]
        if mode[i] != 0.0:
            room.net[i] -= torque_at(effects.address[e], x, effects.parameters[e])
            continue
        x[DIRECTION] = 1.0
        forwards = torque_at(effects.address[e], x, effects.parameters[e])
        x[DIRECTION] = -1.0
        backwards = torque_at(effects.address[e], x, effects.parameters[e])
        room.net[i] -= (forwards + backwards) / 2.0
        room.slip[i] += (forwards - backwards) / 2.0
    for i in range(q.size):
        room.hold[i] = max(chain.friction[i, 2], room.slip[i], 0.0)


@compiled
def take_up(effects: EffectTable, chain: Chain, t: float, taken: int) -> int:
    """Put on the last link what its far end carries from now on; return how many loads it then carries.

    Loads stand in the order of their times.
    """
    last = chain.inertial.shape[0] - 1
    while taken < effects.payload.shape[0] and effects.payload[taken, 0] <= t:
        mass, a, link = effects.payload[taken, 1], chain.geometry[last, 1], chain.inertial[last]
        link[1] += mass * a * a
        link[2] += mass * a * a
        link[6] += mass * a
        link[9] += mass
        taken += 1
    return taken


@compiled
def friction_alone(chain: Chain, effects: EffectTable, room: Room) -> None:
    """Fill in what friction is without effects, and which joints change with their direction."""
    for i in range(chain.friction.shape[0]):
        room.slip[i] = chain.friction[i, 1]
        room.hold[i] = max(chain.friction[i, 2], chain.friction[i, 1], 0.0)
        room.directed[i] = bool(chain.friction[i, 1] != 0.0 or chain.friction[i, 2] > 0.0 or effects.directed[i])
