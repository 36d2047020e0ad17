"""What a server can play: a stored motion and a live one both are that."""

import pytest

from playback.live import LivePlayer
from playback.playable import Playable
from playback.player import Player

MEMBERS = {name for name in vars(Playable) if not name.startswith("_")}


@pytest.mark.parametrize("kind", [Player, LivePlayer])
def test_a_player_has_all_that_a_server_asks_for(kind: type) -> None:
    plain = {"name", "arm", "playing", "finished", "waits_on"}
    assert plain < MEMBERS
    for name in MEMBERS - plain:
        assert callable(getattr(kind, name)), name
    assert not any(callable(getattr(kind, name, None)) for name in plain)  # read, never called
