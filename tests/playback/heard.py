"""What a subscriber hears of a playback."""

from typing import Any

import pytest

from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS


def receive(subscriber: Subscriber, topic: str) -> dict[str, Any]:
    """Return the next message of a topic."""
    while (message := subscriber.receive(PATIENCE_MS)) is not None:
        if message[0] == topic:
            return message[1]
    pytest.fail(f"no {topic} came")
