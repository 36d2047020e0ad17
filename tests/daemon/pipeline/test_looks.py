"""When the ring is looked into, beside a reader that writes at a pace of its own."""

import pytest

from daemon.acquisition.ring import Chunk
from daemon.pipeline.looks import Looks


def waits_ms(pace_ms: float, late_ms: float = 0.0, busy_ms: float = 0.5) -> list[list[float]]:
    """Return for each look how long the chunks that it finds have waited, after the first few looks.

    The reader writes every ``pace_ms``, each second time by ``late_ms`` late; a look takes ``busy_ms``.
    """
    written = [pace_ms * k + late_ms * (k % 2) for k in range(1, 400)]
    looks, now_ms, taken, waited = Looks(), 0.0, 0, []
    while now_ms < written[-1]:
        found = [at for at in written[taken:] if at <= now_ms]
        waited.append([now_ms - at for at in found])
        taken += len(found)
        chunks = [Chunk(round(1e6 * at), b"") for at in found]
        now_ms += busy_ms
        now_ms += 1e3 * looks.wait_s(chunks, round(1e6 * now_ms))
    return waited[5:-1]


def test_a_look_comes_with_every_fourth_turn_of_the_reader() -> None:
    waited = waits_ms(6.2)
    assert {len(one) for one in waited} == {4}
    assert max(one[-1] for one in waited) < 0.5
    assert max(one[0] for one in waited) < 3.0 * 6.2 + 0.5


@pytest.mark.parametrize(("pace_ms", "turns"), [(1.0, 26), (9.0, 2), (16.0, 1)])
def test_it_keeps_to_other_paces(pace_ms: float, turns: int) -> None:
    """A reader that takes much reads more often; a USB converter may bring bytes every 16 ms."""
    waited = waits_ms(pace_ms)
    assert {len(one) for one in waited} == {turns}
    assert max(one[-1] for one in waited) < 0.5


def test_a_reader_that_is_not_on_time_is_found_soon() -> None:
    assert max(max(one, default=0.0) for one in waits_ms(6.2, late_ms=3.0)) < 3.0 * 6.2 + 10.0


def test_where_nothing_comes_a_look_comes_after_a_block_s_time() -> None:
    looks = Looks()
    assert looks.wait_s([], 10**9) == pytest.approx(0.010)
    assert looks.wait_s([Chunk(10**9, b"a")], 10**9) == pytest.approx(0.010)  # no pace is known yet
    looks.wait_s([Chunk(10**9 + 6 * 10**6, b"a")], 10**9 + 6 * 10**6)
    assert looks.wait_s([], 5 * 10**9) == pytest.approx(0.010)  # it was due long ago


def test_a_silence_is_no_pace_of_the_reader() -> None:
    looks = Looks()
    looks.wait_s([Chunk(0, b"a")], 0)
    assert looks.wait_s([Chunk(10**9, b"a")], 10**9) <= 0.032
