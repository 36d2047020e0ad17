"""Contact that no plate measures: looked for first, since it would be learnt as mass.

Two things show it. *Closure*: what the plates carry must be what the person weighs, and what changes its
momentum. Over a second that change is small and well known, whatever the segments weigh. *A hand that stands
still* in the laboratory while the trunk sways holds something that stands.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.ground.floating_base import FloatingBase
from fitter.ground.link_motion import LinkMotion
from limbcal.note import Note
from protocol.markers.recording import runs

#: Closure is judged by means over this long [s]: an error of the velocity of 0.1 m/s is then 1 % of the weight.
_WINDOW_S = 1.0
#: Share of the weight by which such means may differ among one another: five times that. Squats and standing
#: close to 3 % without any mean.
_VARIES = 0.05
#: Horizontal force that changes no momentum, as a share of the weight: what plates that lean by a degree read, and
#: over a second what segments that differ from the table make of a lively motion.
_LEAN, _HORIZONTAL = 0.0175, 0.04
#: Share of the weight by which all of them may differ from what the person is said to weigh: clothes, a wrong
#: entry, and segments that differ from the table.
OTHER_WEIGHT = 0.2
#: Largest motion of a hand that holds something [m, rms], time [s], least motion of the trunk meanwhile [m, rms]:
#: optical noise and skin at rest make 2 mm.
_STILL_M, _STILL_S, _SWAY_M = 0.003, 2.0, 0.010
#: What is lower than this above the point where the ground acts is a foot, and the plates' own matter [m].
_ABOVE_GROUND_M = 0.3


def closure(
    predicted: Floats, measured: Floats, weight_N: float, up: Floats, t: Floats, dt_s: float
) -> list[Note]:
    """Return where the plates carry what the person neither weighs nor accelerates.

    Parameters
    ----------
    predicted, measured : (n_sample, 3) [N]
        ``sum m (a - g)`` by the arm's own masses, and the ground's force.
    weight_N : float
        That the person is said to have.
    up : (3,)
        Away from gravity, of length one.
    t : (n_sample,) [s]
    dt_s : float
    """
    n = max(1, min(len(t), round(_WINDOW_S / dt_s)))
    share = _means(measured - predicted, n) / weight_N
    middle = t[: len(share)] + 0.5 * (n - 1) * dt_s
    vertical = share @ up
    level = float(np.median(vertical))
    if abs(level) > OTHER_WEIGHT:
        return [_carried(_means(measured, n) @ up / weight_N, vertical, weight_N, middle, 0.5 * (n - 1) * dt_s)]
    sideways = np.linalg.norm(share - vertical[:, None] * up, axis=1)
    notes = []
    whole = np.mean(measured - predicted, axis=0) / weight_N
    steady = float(np.linalg.norm(whole - (whole @ up) * up))
    if steady > _LEAN + (_HORIZONTAL - _LEAN) * _WINDOW_S / max(len(t) * dt_s, _WINDOW_S):
        text = (
            f"the plates read {100.0 * steady:.1f} % of the weight sideways throughout, which moves nothing: "
            "something else is touched, such as a rail"
        )
        notes.append(Note("unmeasured_contact", text))
    for bad, said in (
        (np.abs(vertical - level) > _VARIES, "weighs and accelerates"),
        (sideways > _HORIZONTAL, "accelerates sideways"),
    ):
        if not bad.any():
            continue
        first, last = max(runs(bad), key=lambda run: run[1] - run[0])
        worst = float(np.abs((vertical - level) if "weighs" in said else sideways)[bad].max())
        text = (
            f"over a second the plates differ by up to {100.0 * worst:.0f} % of the weight from what the person "
            f"{said}: something else is touched, such as a rail, a box or the floor beside the plates"
        )
        ends = float(middle[first]) - 0.5 * n * dt_s, float(middle[last - 1]) + 0.5 * n * dt_s
        notes.append(
            Note("unmeasured_contact", text, from_s=max(ends[0], float(t[0])), to_s=min(ends[1], float(t[-1])))
        )
    return notes


def _carried(carried: Floats, vertical: Floats, weight_N: float, middle: Floats, half_s: float) -> Note:
    """Return that the plates carry another weight: throughout, or between when and when.

    Parameters
    ----------
    carried, vertical : (n_window,)
        What they carry over a second, and by how much that is not what the person weighs and accelerates, as
        shares of the weight.
    weight_N : float
    middle : (n_window,) [s]
        Of those seconds, which begin and end ``half_s`` from there.
    """
    kg = weight_N / 9.80665
    if np.ptp(vertical) <= 2.0 * _VARIES:
        text = (
            f"the plates carry {float(np.mean(carried)):.2f} of the weight of {kg:.1f} kg throughout: something "
            "else carries the person, such as a plate that is not in the file, or the mass is another's"
        )
        return Note("unmeasured_contact", text)
    first, last = max(runs(np.abs(vertical) > OTHER_WEIGHT), key=lambda run: run[1] - run[0])
    text = (
        f"over a second the plates carry between {carried.min():.2f} and {carried.max():.2f} of the weight of "
        f"{kg:.1f} kg: something else carries the person for a time, such as a chair or the floor beside a plate"
    )
    begin, end = float(middle[first]) - half_s, float(middle[last - 1]) + half_s
    return Note("unmeasured_contact", text, from_s=begin, to_s=end)


def held(
    base: FloatingBase,
    motions: Sequence[LinkMotion],
    ends: Sequence[int],
    names: Sequence[str],
    ground_m: Floats,
    up: Floats,
    t: Floats,
    dt_s: float,
) -> list[Note]:
    """Return which of the tree's last links stand still in the laboratory, high above the ground, while it moves.

    Parameters
    ----------
    base : FloatingBase
    motions : sequence of LinkMotion
        Of all links.
    ends : sequence of int
        Bodies that nothing hangs on, from 0.
    names : sequence of str
        Of those.
    ground_m : (3,)
        Where the ground acts.
    up : (3,)
    t : (n_sample,) [s]
    dt_s : float
    """
    n = round(_STILL_S / dt_s)
    if len(t) < n:
        return []
    heaviest = base.bodies[int(np.argmax(base.links[:, 9]))]
    sways = _scatter(_centre(base, motions, heaviest), n)
    notes = []
    for end, name in zip(ends, names, strict=True):
        place = motions[end].o
        if float(np.median((place - ground_m) @ up)) < _ABOVE_GROUND_M:
            continue
        still = (_scatter(place, n) < _STILL_M) & (sways > _SWAY_M)
        if still.any():
            first, last = max(runs(still), key=lambda run: run[1] - run[0])
            text = (
                f"{name} stands still within {1e3 * _STILL_M:.0f} mm while the trunk sways: it holds something "
                f"that no plate measures"
            )
            notes.append(
                Note("unmeasured_contact", text, from_s=float(t[first]), to_s=float(t[min(last + n, len(t)) - 1]))
            )
    return notes


def plate_link(
    base: FloatingBase, motions: Sequence[LinkMotion], points_m: Floats, loaded: NDArray[np.bool_]
) -> int:
    """Return the body, from 0, whose centre is nearest to where a plate is loaded, in the median.

    Parameters
    ----------
    points_m : (n_sample, 3)
        Of the force's application.
    loaded : (n_sample,) bool
    """
    far = [
        float(np.median(np.linalg.norm(_centre(base, motions, body) - points_m, axis=1)[loaded]))
        for body in base.bodies
    ]
    return base.bodies[int(np.argmin(far))]


def _centre(base: FloatingBase, motions: Sequence[LinkMotion], body: int) -> Floats:
    link = base.links[base.bodies.index(body)]
    return np.asarray(motions[body].o + motions[body].R @ (link[6:9] / link[9]))


def _means(values: Floats, n: int) -> Floats:
    total = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0)])
    return np.asarray((total[n:] - total[:-n]) / n)


def _scatter(place: Floats, n: int) -> Floats:
    """Return the rms distance from its mean in every window of n samples, (n_sample - n + 1,)."""
    place = place - place.mean(axis=0)
    variance = _means(place**2, n) - _means(place, n) ** 2
    return np.asarray(np.sqrt(np.maximum(variance.sum(axis=1), 0.0)))
