"""What one recording showed is known to the next, and what an exact arm does not explain is smoothed anew."""

from types import SimpleNamespace

import pytest

from limbcal.errors import DataError
from tracking.smoother import explained_runs
from tracking.smoother.explained_runs import exact_motions, explained, runs_smoothed

RUNS = ["first", "second", "third"]


class ScriptedSmoothers:
    """Stands for both smoothers: explains the given runs, and notes what it was asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, alike: set[str], late: set[str], broken: str = "") -> None:
        self.explains, self.broken = {False: alike, True: late}, broken
        self.asked: list[tuple[object, ...]] = []
        self.explaining = False
        monkeypatch.setattr(explained_runs, "Smoother", lambda *made: self.exact(made))
        monkeypatch.setattr(explained_runs, "DiscrepancySmoother", lambda *made: self.robust(made))

    def exact(self, made: tuple[object, ...]) -> SimpleNamespace:
        assert made[:4] == ("arm", "q", True, "prior")
        clocks = made[4]

        def smooth(
            readings: str, fine: bool, known: object, progress: object, explaining: bool
        ) -> SimpleNamespace:
            assert (fine, progress) == (False, None)
            assert explaining == (clocks or self.explaining)  # a second try is given up once it is vain
            self.asked.append((clocks, readings, known and known.name))
            if readings == self.broken:
                raise DataError("no motion")
            return SimpleNamespace(name=readings, clocks=clocks, is_exact=readings in self.explains[clocks])

        return SimpleNamespace(smooth=smooth)

    def robust(self, made: tuple[object, ...]) -> SimpleNamespace:
        assert made == ("arm", "q", True, "prior")

        def smooth(readings: str, exact: object, known: object, progress: object) -> SimpleNamespace:
            assert progress is None
            self.asked.append(("robust", readings, exact and exact.name, known and known.name))
            return SimpleNamespace(name=f"{readings}, robust", is_exact=False)

        return SimpleNamespace(smooth=smooth)


def exactly() -> list[SimpleNamespace]:
    return exact_motions("arm", RUNS, "q", True, "prior", None)


def test_each_run_knows_the_one_before(monkeypatch: pytest.MonkeyPatch) -> None:
    smoothers = ScriptedSmoothers(monkeypatch, {*RUNS}, set())
    found = exactly()
    assert [one.name for one in found] == RUNS and explained(found, RUNS)
    assert smoothers.asked == [(False, "first", None), (False, "second", "first"), (False, "third", "second")]
    assert runs_smoothed("arm", RUNS, "q", True, "prior", None)[2].name == "third"


def test_clocks_differ_only_where_alike_they_explain_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    smoothers = ScriptedSmoothers(monkeypatch, {"first"}, {*RUNS})
    found = exactly()
    assert [one.clocks for one in found] == [True] * 3
    assert smoothers.asked[:3] == [(False, "first", None), (False, "second", "first"), (True, "first", None)]


def test_a_first_try_can_be_given_up_too(monkeypatch: pytest.MonkeyPatch) -> None:
    smoothers = ScriptedSmoothers(monkeypatch, set(), set())
    smoothers.explaining = True
    exact_motions("arm", RUNS, "q", True, "prior", None, explaining=True)
    assert smoothers.asked == [(False, "first", None), (True, "first", None)]


def test_what_no_motion_explains_at_all_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    smoothers = ScriptedSmoothers(monkeypatch, {*RUNS}, {*RUNS}, broken="first")
    assert exactly() == [] and smoothers.asked == [(False, "first", None)]
    ScriptedSmoothers(monkeypatch, {*RUNS}, {*RUNS}, broken="second")
    found = exactly()
    assert [(one.name, one.clocks) for one in found] == [("first", False)] and not explained(found, RUNS)


@pytest.mark.parametrize(("last", "all_of_them"), [(True, True), (False, False)])
def test_all_runs_are_explained_if_the_last_is(last: bool, all_of_them: bool) -> None:
    found = [SimpleNamespace(is_exact=True), SimpleNamespace(is_exact=last)]
    assert explained(found, RUNS[:2]) == all_of_them
    assert not explained(found, RUNS) and not explained([], RUNS)


def test_otherwise_every_run_is_smoothed_with_what_the_model_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    smoothers = ScriptedSmoothers(monkeypatch, {"first"}, {"first"})
    found = runs_smoothed("arm", RUNS, "q", True, "prior", None)
    assert [one.name for one in found] == [f"{run}, robust" for run in RUNS]
    assert smoothers.asked[4:] == [
        ("robust", "first", "first", None),
        ("robust", "second", "second", "first, robust"),
        ("robust", "third", None, "second, robust"),
    ]
