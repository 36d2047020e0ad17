"""How far a search's answer is from the bundle fit's, on the same objective (Fig. 6 on a person)."""

from dataclasses import dataclass, replace

import numpy as np

from arm.body.landmarks import LimbMap
from arm.model import Floats
from fitter.limb.bundle import Bundle, Task, cost_of
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.limb_search import Found
from fitter.limb.uncertainty import derived
from limbcal.command import Document
from limbcal.note import Note

#: An answer whose cost is higher by no more than this is in the same minimum: three standard errors of one number.
SAME_MINIMUM = 9.0


@dataclass(frozen=True)
class Compared:
    """How far a method's answer is from the bundle fit's.

    Attributes
    ----------
    cost : float
        The objective on all frames, minus that of the bundle fit, at the latter's scale: minus twice a log
        posterior, of which 1 is one standard error of one number.
    marker_rms_m : float
        Of the distances from the measured markers, over all frames.
    apart_m : float
        Rms of the distances between both answers' markers.
    centres_apart_m : float
        Of the joint centres, in their segments, rms over them.
    """

    cost: float
    marker_rms_m: float
    apart_m: float
    centres_apart_m: float


def compared(where: LimbMap, task: Task, bundle: Bundle, other: Bundle) -> Compared:
    """Compare an answer with the bundle fit's.

    Parameters
    ----------
    where : LimbMap
    task : Task
    bundle, other : Bundle
        With the angles of all frames of the task.
    """
    frames, seen = task.frames, np.isfinite(task.frames.y[..., 0])
    mine, theirs = (predicted(one.markers.chain(one.geometry), frames, one.q)[seen] for one in (bundle, other))
    at = [
        derived(where, one.geometry, one.markers.link, one.markers.place, bundle.markers.place).centres
        for one in (bundle, other)
    ]
    centres = [at[1][name][1] - place for name, (_, place) in at[0].items()]
    costs = [
        cost_of(task, one.geometry, replace(one.markers, std=bundle.markers.std), one.q) for one in (bundle, other)
    ]
    return Compared(
        costs[1] - costs[0],
        _rms(theirs - frames.y[seen]),
        _rms(theirs - mine),
        _rms(np.array(centres)),
    )


def _rms(away: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(away**2, axis=-1))))


@dataclass(frozen=True)
class Comparison:
    """The bundle fit, the genetic algorithm, and the bundle fit that begins where the latter ended.

    Attributes
    ----------
    found : mapping of str to Found
        By ``bundle``, ``ga`` and ``ga+bundle``.
    compared : mapping of str to Compared
    """

    found: dict[str, Found]
    compared: dict[str, Compared]

    def document(self) -> Document:
        """Return what the JSON document has of it."""
        return {
            name: {
                "cost": one.cost,
                "marker_rms_mm": 1e3 * one.marker_rms_m,
                "apart_mm": 1e3 * one.apart_m,
                "centres_apart_mm": 1e3 * one.centres_apart_m,
                "cpu_s": self.found[name].seconds,
                "generations": self.found[name].bundle.iterations,
                "population": self.found[name].population,
                "samples": self.found[name].frames,
                "converged": self.found[name].bundle.converged,
            }
            for name, one in self.compared.items()
        }

    def notes(self) -> tuple[Note, ...]:
        """Say whether generations or frames were too few, and whether one of both is in a worse minimum."""
        ga, said = self.found["ga"], list[Note]()
        if not ga.bundle.converged:
            text = (
                f"after {ga.bundle.iterations} generations of {ga.population} the population is not one point: "
                "give it more generations"
            )
            said.append(Note("not_converged", text))
        above, after = self.compared["ga"].cost, self.compared["ga+bundle"].cost
        if after < -SAME_MINIMUM:
            text = (
                "from where the genetic algorithm ended the bundle fit finds an answer whose cost is lower by "
                f"{-after:.0f}: by itself, from landmarks, it ends in another minimum"
            )
            said.append(Note("other_minimum", text))
        elif after > SAME_MINIMUM:
            text = (
                f"the genetic algorithm ended in another minimum than the bundle fit, whose cost is {after:.0f} "
                "higher (1 is one standard error of one number): take the bundle fit, or another --seed"
            )
            said.append(Note("other_minimum", text))
        elif above > SAME_MINIMUM:
            text = (
                f"the genetic algorithm took {ga.frames} frames; on all {len(ga.bundle.q)} its answer costs "
                f"{above:.0f} more than the bundle fit's (1: a standard error of one number): take the bundle fit"
            )
            said.append(Note("above_bundle", text))
        return tuple(said)


def comparison(where: LimbMap, task: Task, found: dict[str, Found]) -> Comparison:
    """Compare all that was found with the bundle fit."""
    bundle = found["bundle"].bundle
    return Comparison(found, {name: compared(where, task, bundle, one.bundle) for name, one in found.items()})
