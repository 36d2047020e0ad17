"""What somebody may have meant who mistyped a name."""

import difflib
from collections.abc import Iterable

#: Least similarity of two names, 0 to 1: the default of `difflib.get_close_matches`.
_CUTOFF = 0.6


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'name'?"`` with the known name nearest to a word; empty where none is near.

    Upper and lower case, ``-`` and ``_`` count as the same, and dashes before an option as nothing.
    """
    by_form = {_form(name): name for name in known}
    nearest = difflib.get_close_matches(_form(word), by_form, n=1, cutoff=_CUTOFF)
    return f"; did you mean {by_form[nearest[0]]!r}?" if nearest else ""


def _form(word: str) -> str:
    return word.lstrip("-").lower().replace("_", "-")
