"""What is right: an answer that holds, a sentence that names the cause, or silence."""

import re
from collections.abc import Callable

from arm.model import Arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from benchmarks.contradictions.commands import Ran

#: Standard errors within which a parameter is right: chance takes one in 1.7 million further (normal).
STD_OFF = 5.0
QUESTIONS = re.compile(
    r"\?|unwrapped|do not count|left out|repeat the row|ms late|impossible|next to nothing", re.I
)

Right = Callable[[Ran], bool]


def says(pattern: str, code: int | None = None) -> Right:
    """Right is a sentence with these words, and an exit code where one is asked for."""
    return lambda ran: bool(re.search(pattern, ran.said)) and (code is None or ran.code == code)


def holds(arm: Arm, *words: str, off: float = STD_OFF) -> Right:
    """Right is an answer within `STD_OFF` standard errors (or 1 %), with these words."""
    base = structural_parameters(arm)
    true = dict(zip(base.names, (base.combination @ standard_parameters(arm)).tolist(), strict=True))

    def right(ran: Ran) -> bool:
        if ran.code != 0 or not all(re.search(word, ran.said) for word in words):
            return False
        found = ran.document["parameters"]
        return all(
            abs(found[name]["value"] - value) <= off * found[name]["std"] + 0.01 * abs(value)
            for name, value in true.items()
            if found[name]["identifiable"] and found[name]["std"] is not None
        )

    return right


def holds_or_says(arm: Arm, word: str, off: float = STD_OFF) -> Right:
    """Right is an answer that holds, or none with a sentence that names the cause."""
    return lambda ran: holds(arm, off=off)(ran) or (ran.code == 4 and bool(re.search(word, ran.said)))


def silent_and_right(arm: Arm) -> Right:
    """Right is an answer that holds, without a question."""
    return lambda ran: holds(arm)(ran) and not QUESTIONS.search(ran.said)


def silent(ran: Ran) -> bool:
    """Right is an answer without a question."""
    return ran.code == 0 and not QUESTIONS.search(ran.said)
