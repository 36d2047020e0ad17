"""Text from anybody, as a terminal or a journal may have it."""

import unicodedata

#: What starts a line or a column is layout, not a control of the terminal.
_LAYOUT = "\n\t"


def escaped(text: str) -> str:
    """Return a text with its control, format and surrogate characters written out, as Python's repr does."""
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character in _LAYOUT or not unicodedata.category(character).startswith("C"):
        return character
    return character.encode("unicode_escape").decode("ascii")
