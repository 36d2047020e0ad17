"""Running several experiments."""

from fitter.experiments.experiment import Settings
from fitter.experiments.reproduction import EXPERIMENTS, reproduce


def test_two_processes_find_what_one_does_in_the_papers_order():
    said: list[tuple[str, str]] = []
    settings = Settings(seed=1, quick=True)
    names = ["table6", "table3"]
    together = reproduce(names, settings, 2, lambda *what: said.append(what))
    alone = reproduce(names, settings, 1, lambda *_: None)
    assert [outcome.name for outcome in together] == ["table3", "table6"]
    for one, other in zip(together, alone, strict=True):
        assert one.experiment is not None
        assert other.experiment is not None
        assert one.experiment.grids == other.experiment.grids
        assert one.experiment.findings == other.experiment.findings
    assert {name for name, what in said if not what} == {"table3", "table6"}


def test_every_table_and_figure_with_results_has_an_experiment():
    assert set(EXPERIMENTS) == {*(f"table{k}" for k in range(1, 7)), "fig6", "fig7", "fig8"}


def test_one_that_fails_says_why_and_the_others_go_on():
    # 1000 samples of the learning set are too few to choose a filter from noise of ten per cent
    outcomes = reproduce(["table3", "table6"], Settings(samples=60, quick=True), 1, lambda *_: None)
    assert [outcome.experiment is None for outcome in outcomes] == [outcome.error is not None for outcome in outcomes]
    assert outcomes[-1].experiment is not None
