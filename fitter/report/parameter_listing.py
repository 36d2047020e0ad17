"""Rows of fitted parameters as a person reads them, at the terminal and in a report alike."""

from collections.abc import Mapping
from dataclasses import dataclass

from fitter.search.fitted_parameter import FittedParameter
from limbcal.digits import to_the_place_of, with_half_width

#: Stands in place of a value that the data says nothing of.
NOT_IDENTIFIABLE = "not identifiable"
#: The heading of a row's own cells; those of other arms come between the last two.
HEADING = ("parameter", "value", "± (95 %)", "unit")


@dataclass(frozen=True)
class ParameterRow:
    """One parameter, printed.

    Attributes
    ----------
    name, value, half_width, unit : str
        Value and half-width of the 95 % interval to the same decimal place; ``not identifiable`` and a dash where
        the data says nothing of it.
    others : tuple of str
        The values of other arms, to the same place.
    """

    name: str
    value: str
    half_width: str
    unit: str
    others: tuple[str, ...] = ()

    @property
    def cells(self) -> tuple[str, ...]:
        """The row's cells, in the order of `heading`."""
        return (self.name, self.value, self.half_width, *self.others, self.unit)


def heading(others: Mapping[str, object]) -> tuple[str, ...]:
    """Return the heading of a table with the values of other arms, by the arms' names."""
    return (*HEADING[:-1], *others, HEADING[-1])


def parameter_rows(
    parameters: Mapping[str, FittedParameter], others: Mapping[str, Mapping[str, float]]
) -> list[ParameterRow]:
    """Return a row a parameter.

    Parameters
    ----------
    parameters : mapping from name to FittedParameter
    others : mapping from an arm's name to its values by the parameters' names
    """
    rows = []
    for name, parameter in parameters.items():
        half_width = parameter.half_width
        value, around = with_half_width(parameter.value, half_width)
        if not parameter.identifiable:
            value, around = NOT_IDENTIFIABLE, "–"
        known = tuple(
            to_the_place_of(values[name], half_width) if name in values else "–" for values in others.values()
        )
        rows.append(ParameterRow(name, value, around, parameter.unit, known))
    return rows
