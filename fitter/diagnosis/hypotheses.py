"""All that may be wrong with the arm: every effect of the catalogue at every place where it can be."""

from arm.effects.catalogue import catalogue
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.in_arm import arm_hypotheses
from fitter.diagnosis.in_drive import drive_hypotheses
from fitter.diagnosis.in_friction import FrictionDrift
from fitter.diagnosis.in_transmission import InTransmission

#: These come about at certain times or trials, which are found in what the others leave.
EVENTS = ("external_push", "payload")
#: What the base model has already, unless it was denied it.
_IN_BASE = {"viscous": "D", "coulomb": "fc"}


def hypotheses(n_joint: int, denied: tuple[str, ...] = (), driven: bool = True) -> list[Hypothesis]:
    """Return every hypothesis about the joints that is no event.

    Parameters
    ----------
    n_joint : int
    denied : tuple of str
        Frictions that the base model leaves out: ``D``, ``fc``.
    driven : bool
        Whether a torque drives the arm: without one nothing can go wrong on its way.
    """
    found: list[Hypothesis] = []
    for name, kind in catalogue().items():
        if kind.place == "sensor" or name in EVENTS or (name in _IN_BASE and _IN_BASE[name] not in denied):
            continue
        if not driven and (kind.place in ("drive", "transmission") or name == "load_friction"):
            continue
        if name == "thermal_drift":
            found += [FrictionDrift(kind, (j,)) for j in range(n_joint)]
        elif kind.place == "joint":
            sides = [{"side": -1.0}, {"side": 1.0}] if any(p.name == "side" for p in kind.parameters) else [{}]
            found += [AtJoint(kind, j, side) for j in range(n_joint) for side in sides]
        elif kind.place == "drive":
            found += drive_hypotheses(kind, n_joint)
        elif kind.place == "transmission":
            found += [InTransmission(kind, (j,)) for j in range(n_joint)]
        else:
            found += arm_hypotheses(kind, n_joint)
    return found
