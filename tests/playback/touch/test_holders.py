"""Of devices that speak, who began last holds the arm, until 20 ms of silence."""

from playback.touch.holders import Holders


def test_nobody_holds_at_first() -> None:
    holders = Holders()
    assert holders.holder(0.0) is None and len(holders) == 0


def test_who_goes_on_speaking_goes_on_holding() -> None:
    holders = Holders()
    for k in range(100):
        holders.hear(b"a", 0.015 * k)
        assert holders.holder(0.015 * k + 0.01) == b"a"
    assert len(holders) == 1


def test_silence_of_20_ms_lets_go() -> None:
    holders = Holders()
    holders.hear(b"a", 1.0)
    assert holders.holder(1.0 + 0.0199) == b"a"
    assert holders.holder(1.0 + 0.0201) is None
    assert len(holders) == 0


def test_the_last_touch_holds_and_hands_back() -> None:
    holders = Holders()
    holders.hear(b"a", 0.0)
    holders.hear(b"b", 0.005)
    holders.hear(b"a", 0.010)  # goes on, begins nothing
    assert holders.holder(0.011) == b"b"
    holders.hear(b"a", 0.020)
    assert holders.holder(0.026) == b"a" and len(holders) == 1


def test_after_a_silence_a_touch_begins_anew() -> None:
    holders = Holders()
    holders.hear(b"a", 0.0)
    for k in range(1, 5):
        holders.hear(b"b", 0.01 * k)
    assert holders.holder(0.04) == b"b"
    holders.hear(b"a", 0.045)
    assert holders.holder(0.046) == b"a"


def test_of_two_in_one_tick_the_later_heard_holds() -> None:
    holders = Holders()
    holders.hear(b"a", 0.0)
    holders.hear(b"b", 0.0)
    assert holders.holder(0.0) == b"b"
    again = Holders()
    again.hear(b"a", 0.0)
    again.hear(b"b", 1.0)
    again.hear(b"a", 1.0)
    assert again.holder(1.0) == b"a"
