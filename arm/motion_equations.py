"""The equations of motion as `arm.integration` solves them, step by step and without making arrays."""

from arm.chain import Chain, poses
from arm.composite_bodies import mass_rows
from arm.drive import SHARE, TORQUE, Commands, drive_at, go_its_way
from arm.effects.effect_table import EffectTable
from arm.effects.joint_numbers import ROTOR
from arm.model import Floats
from arm.newton_euler import rigid_motion, rigid_torque
from arm.resistance import resist
from arm.room import Room
from limbcal.compiled import compiled, inlined


@compiled
def solve(A: Floats, x: Floats) -> None:
    """Turn ``x`` into ``A^-1 x`` by elimination with partial pivoting; ``A`` is used up."""
    n = x.size
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if pivot != k:
            x[k], x[pivot] = x[pivot], x[k]
            for j in range(k, n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            x[i] -= factor * x[k]
            for j in range(k + 1, n):
                A[i, j] -= factor * A[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            x[k] -= A[k, j] * x[j]
        x[k] /= A[k, k]


@inlined
def equations(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    k: int,
    share: float,
    h: float,
    q: Floats,
    dq: Floats,
    mode: Floats,
    room: Room,
) -> None:
    """Set up ``M ddq = net``: the law's share of ddq is on the left, Coulomb friction is not in it.

    That is at a share of step ``k``, ``h`` seconds into a stretch. A joint at rest that may go either way must
    have ``mode`` 0 where there are effects.
    """
    n, law, way = q.size, commands.law, room.way.state
    drive_at(commands, k, share, room.now)
    poses(chain, q, room.R, room.p)
    mass_rows(chain, room.R, room.p, room.branch, room.M)
    rigid_motion(chain, chain.gravity, room.R, room.p, dq, room.zero[:n], room.motion)
    rigid_torque(chain, room.R, room.p, room.motion, room.zero[-6:], room.branch, room.bias)
    if effects.driven:
        go_its_way(commands, effects, room.way, k, share, h, q, dq, room.now)
    for i in range(n):
        if not effects.driven:
            drive = room.now[i]
            way[TORQUE, i] = (
                drive if commands.given else law[0, i] * (drive - q[i]) + law[1, i] * dq[i]
            )  # (5), (7)
        room.net[i] = way[TORQUE, i] - room.bias[i] - chain.friction[i, 0] * dq[i]
        room.M[i, i] -= way[SHARE, i] * law[2, i]  # eq. (6): ka ddq belongs with M ddq
        room.M[i, i] += effects.numbers[ROTOR, i]
    if effects.joint.size > 0:
        resist(chain, commands, effects, commands.t0 + (k + share) * commands.dt, q, dq, mode, room)


@inlined
def acceleration(mode: Floats, room: Room, ddq: Floats) -> None:
    """Solve the equations with every joint in its mode; a stuck joint does not accelerate."""
    for i in range(ddq.size):
        if mode[i] == 0.0:
            room.A[i] = 0.0
            room.A[i, i] = 1.0
            ddq[i] = 0.0
        else:
            room.A[i] = room.M[i]
            ddq[i] = room.net[i] - room.slip[i] * mode[i]
    solve(room.A, ddq)
    for i in range(ddq.size):
        if mode[i] == 0.0:
            ddq[i] = 0.0  # to the last bit: pivoting may have left rounding there
