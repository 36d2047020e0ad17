"""Parts of a stream to follow, and what a subscription leaves."""

from protocol.message import TRIAL

LIMIT = ("--seconds", "60")


def until(messages, trial, state):
    """Return the messages up to an announcement."""
    last = next(
        k
        for k, (topic, fields) in enumerate(messages)
        if topic == TRIAL and (fields["trial"], fields["state"]) == (trial, state)
    )
    return messages[: last + 1]


def names(folder):
    return sorted(path.name for path in folder.iterdir())
