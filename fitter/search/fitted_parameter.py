"""A parameter as a fit reports it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

NORMAL_95 = 1.959964


@dataclass(frozen=True)
class FittedParameter:
    """A value, how far it can be trusted, and whether the data said anything of it.

    Attributes
    ----------
    value, std : float
        ``std`` is the standard error, NaN where the value was not learnt or the data is too short to tell.
    unit : str
    identifiable : bool
        False where the value is the prior's, or stands only together with such a one.
    """

    value: float
    std: float
    unit: str
    identifiable: bool

    @property
    def ci95(self) -> tuple[float, float] | None:
        """The interval that holds the truth in 95 of 100 cases; None where nothing is known of it."""
        if not np.isfinite(self.std):
            return None
        return self.value - NORMAL_95 * self.std, self.value + NORMAL_95 * self.std

    def document(self) -> dict[str, object]:
        """Return the parameter as it stands in a fit's JSON document."""
        return {
            "value": self.value,
            "std": self.std,
            "unit": self.unit,
            "identifiable": self.identifiable,
        }


def fitted_parameters(
    names: Sequence[str], values: Floats, std: Floats, units: Sequence[str], identifiable: NDArray[np.bool_]
) -> dict[str, FittedParameter]:
    """Return parameters by their names, from one array each of what is known of them."""
    return {
        name: FittedParameter(float(values[k]), float(std[k]), units[k], bool(identifiable[k]))
        for k, name in enumerate(names)
    }
