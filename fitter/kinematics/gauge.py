"""The freedom that the data leaves: which numbers of eq. (1) show only together, or not at all.

Displacements of the tip don't say where the base stands or how it is turned, where along parallel axes a link
sits, or where a joint counts from if nothing fixes the link before it. Such a freedom is a null vector of the
jacobian of all parameters and the base's orientation, at the geometry that was found, with axes that are nearly
parallel taken to be so (Hayati 1983): their angle by noise has no information of d.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.kinematics.identifiability import RESOLUTION_M, SMALLEST_SHARE, by_preference

#: Parameters whose effect is below this fraction of a dependent one's are no part of its group.
_PART = 0.02
#: What stands still where a freedom is of identified parameters alone.
_BASE = "the base as the arm file has it"


@dataclass(frozen=True)
class Gauge:
    """Parameters of which only a combination, or nothing, shows in the data.

    Attributes
    ----------
    parameters : tuple of str
    why : str
    """

    parameters: tuple[str, ...]
    why: str

    def sentence(self, identifiable: Collection[str]) -> str:
        """Return the freedom in words.

        Parameters
        ----------
        identifiable : collection of str
            Parameters that the fit determines, those that it does not being as the arm file has them.
        """
        known = [name for name in self.parameters if name in identifiable]
        unknown = [name for name in self.parameters if name not in identifiable]
        if not known:
            return f"not identified: {', '.join(unknown)}: {self.why}"
        they = "it" if len(unknown) == 1 else "them"
        given = f"{', '.join(unknown)} as the arm file has {they}" if unknown else _BASE
        return f"identified only with {given} given: {', '.join(known)}: {self.why}"

    def document(self) -> dict[str, object]:
        """Return the freedom as it stands in a fit's JSON document."""
        return {"parameters": list(self.parameters), "why": self.why}


def gauge(names: Sequence[str], effects: Floats, base: Floats) -> tuple[Gauge, ...]:
    """Find the freedoms.

    Parameters
    ----------
    names : (n_parameter,)
        Of all parameters, five a joint.
    effects : (n_parameter, n)
        What each does to the tip over its whole range, as `identifiable` takes it.
    base : (3, n)
        What turning the base about x, y and z does.

    Returns
    -------
    tuple of Gauge
        One for each dimension of the null space, parameters in the order in which eq. (1) has them.
    """
    order = by_preference(np.arange(len(names)))
    rows = np.vstack([effects[order], base])
    known: list[int] = []
    found = []
    for k, row in enumerate(rows):
        alone = float(np.linalg.norm(row))
        if alone <= RESOLUTION_M:
            if k < len(order):
                found.append(Gauge((names[order[k]],), "the displacement of the tip shows nothing of it"))
            continue
        share, *_ = np.linalg.lstsq(rows[known].T, row, rcond=None)
        residual = float(np.linalg.norm(row - share @ rows[known]))
        if residual > max(RESOLUTION_M, SMALLEST_SHARE * alone):
            known.append(k)
            continue
        does = np.abs(share) * np.linalg.norm(rows[known], axis=1)
        together = [other for other, size in zip(known, does, strict=True) if size > _PART * alone]
        found.append(_gauge_of(names, order, [*together, k]))
    return tuple(found)


def _gauge_of(names: Sequence[str], order: Sequence[int], rows: Sequence[int]) -> Gauge:
    """Return a freedom in words."""
    own = sorted(order[k] for k in rows if k < len(order))
    if len(own) < len(rows):
        why = "the tip moves alike where the base is turned instead"
    elif all(names[k].startswith("d") for k in own):
        why = "the axes are parallel or nearly so, and only the sum of what lies along them shows"
    else:
        why = "only a combination of them shows in the displacement of the tip"
    return Gauge(tuple(names[k] for k in own), why)
