"""Where within a step a joint comes to rest or lets go: the root of what is left before it does.

A bracket (2, 1 + n) holds two shares of the step, before that end and not before it, and how far every joint is
from the end of its mode there: negative beyond.
"""

from arm.model import Floats
from arm.room import Room
from arm.sticking import slack_of
from limbcal.compiled import compiled

#: How exactly it is placed, as a share of the step.
CUT_AT = 1e-13
#: Once in this number of rounds it is sought by bisection, which cannot fail.
_BISECTED = 4


@compiled
def begin_bracket(bracket: Floats, whole: float, mode: Floats, dq: Floats, room: Room, ddq: Floats) -> None:
    """Begin at the start of a stretch, at which the equations are set up and solved, and at its end."""
    bracket[0, 0], bracket[1, 0] = 0.0, whole
    for i in range(dq.size):
        bracket[0, 1 + i] = slack_of(i, mode, dq, room, ddq)
        bracket[1, 1 + i] = 0.0


@compiled
def narrow(bracket: Floats, side: int, share: float, slack: Floats, ended: bool) -> int:
    """Move one side of a bracket to a share of the step; return which one, 0 or 1.

    If it is the ``side`` that was moved last, the slacks at the other are halved, so that it will be the other's
    turn (the Illinois variant of regula falsi; Dowell and Jarratt 1971).
    """
    moved = 1 if ended else 0
    bracket[moved, 0] = share
    for i in range(slack.size):
        bracket[moved, 1 + i] = slack[i]
        if moved == side:
            bracket[1 - moved, 1 + i] *= 0.5
    return moved


@compiled
def next_try(bracket: Floats, rounds: int, side: int) -> float:
    """Return the share at which to look next: where by straight lines the first joint's mode ends.

    It goes a little beyond, away from the ``side`` that was moved last, so that both close in. A joint that has
    no way to go may end its mode at once (masses that none can have push it against its pull); that is tried
    first.
    """
    before, late = float(bracket[0, 0]), float(bracket[1, 0])
    middle = 0.5 * (before + late)
    if rounds % _BISECTED == 0:
        return middle
    found = late
    for i in range(1, bracket.shape[1]):
        first, last = float(bracket[0, i]), float(bracket[1, i])
        if last < 0.0:
            if not first > 0.0:
                return before + CUT_AT if rounds == 1 else middle
            found = min(found, before + first / (first - last) * (late - before))
    found += 0.4 * CUT_AT * (1 - 2 * side)
    return found if before < found < late else middle
