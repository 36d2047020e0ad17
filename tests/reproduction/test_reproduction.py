"""Running several experiments."""

from limbcal.errors import NotConverged
from reproduction import table3, table6
from reproduction.experiment import Experiment, Settings
from reproduction.reproduction import EXPERIMENTS, reproduce


def test_two_processes_find_what_one_does_in_the_papers_order():
    said: list[tuple[str, str]] = []
    settings = Settings(seed=4, quick=True)
    together = reproduce(["table6", "table4"], settings, 2, lambda *what: said.append(what))
    (alone,) = reproduce(["table6"], settings, 1, lambda *_: None)
    assert [outcome.name for outcome in together] == ["table4", "table6"]
    one = together[1].experiment
    assert one is not None
    assert alone.experiment is not None
    assert one.grids == alone.experiment.grids
    assert one.findings == alone.experiment.findings
    assert {name for name, what in said if not what} == {"table4", "table6"}


def test_every_table_and_figure_with_results_has_an_experiment():
    assert set(EXPERIMENTS) == {*(f"table{k}" for k in range(1, 7)), "fig6", "fig7", "fig8"}


def test_one_that_fails_says_why_and_the_others_go_on(monkeypatch):
    def never(_settings: Settings) -> Experiment:
        raise NotConverged("it never will")

    monkeypatch.setattr(table3, "run", never)
    monkeypatch.setattr(table6, "run", lambda settings: Experiment("table6", f"with seed {settings.seed}"))
    failed, other = reproduce(["table6", "table3"], Settings(seed=5), 1, lambda *_: None)
    assert (failed.name, failed.experiment, str(failed.error)) == ("table3", None, "it never will")
    assert other.experiment == Experiment("table6", "with seed 5")
