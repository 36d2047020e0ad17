"""A parameter as a fit reports it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from arm.model import Floats
from limbcal.digits import NORMAL_95


@dataclass(frozen=True)
class FittedParameter:
    """A value, how far it can be trusted, and whether the data said anything of it.

    Attributes
    ----------
    value, std : float
        ``std`` is the standard error, NaN where the value was not learnt or the data is too short.
    unit : str
    identifiable : bool
        False where the value is the prior's, or stands only together with such a one.
    freedom : float
        Degrees of freedom that the standard error was estimated with: how many independent draws or stretches.
    """

    value: float
    std: float
    unit: str
    identifiable: bool
    freedom: float = np.inf

    @property
    def ci95(self) -> tuple[float, float] | None:
        """The interval that holds the truth in 95 of 100 cases; None where nothing is known of it."""
        if not np.isfinite(self.std):
            return None
        reach = NORMAL_95 if np.isinf(self.freedom) else float(stdtrit(self.freedom, 0.975))
        return self.value - reach * self.std, self.value + reach * self.std

    @property
    def half_width(self) -> float:
        """Half-width of the 95 % interval, the longer half where they differ; NaN where nothing is known of it."""
        if self.ci95 is None or not self.identifiable:
            return float(np.nan)
        low, high = self.ci95
        return max(self.value - low, high - self.value)

    def document(self) -> dict[str, object]:
        """Return the parameter as it stands in a fit's JSON document."""
        return {
            "value": self.value,
            "std": self.std,
            "unit": self.unit,
            "identifiable": self.identifiable,
        }


def fitted_parameters(
    names: Sequence[str],
    values: Floats,
    std: Floats,
    units: Sequence[str],
    identifiable: NDArray[np.bool_],
    freedom: float = np.inf,
) -> dict[str, FittedParameter]:
    """Return parameters by their names, from one array each of what is known of them."""
    return {
        name: FittedParameter(float(values[k]), float(std[k]), units[k], bool(identifiable[k]), freedom)
        for k, name in enumerate(names)
    }


def held_back(parameters: Mapping[str, FittedParameter]) -> dict[str, FittedParameter]:
    """Return parameters of which nothing is claimed yet."""
    return {name: replace(p, std=np.nan, identifiable=False, freedom=np.inf) for name, p in parameters.items()}
