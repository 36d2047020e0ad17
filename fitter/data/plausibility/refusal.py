"""A table that is not what it says it is."""

from limbcal.errors import DataError


class Refusal(DataError):  # noqa: N818
    """A question that only the user can answer: what was seen, the likely cause, and how to state it."""
