"""A parameter as a fit reports it."""

from dataclasses import dataclass


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

    def document(self) -> dict[str, object]:
        """Return the parameter as it stands in a fit's JSON document."""
        return {
            "value": self.value,
            "std": self.std,
            "unit": self.unit,
            "identifiable": self.identifiable,
        }
