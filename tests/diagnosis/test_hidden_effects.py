"""Hidden effects found by the command: name, joint and size; it is shown neither the seed nor the truth."""

from pathlib import Path

import pytest

from benchmarks.diagnosed import Found, by_command
from benchmarks.diagnosis_score import score
from benchmarks.hidden_arms.cases import Case, draw_case
from benchmarks.hidden_arms.hiding import Bench
from tests.soak import Long

#: Shorter than the benchmark, so that a case takes seconds.
SHORT = Bench(trial_s=3.0, learning=2, evaluating=2)
#: A period shows in more motions only.
LONGER = Bench(trial_s=3.0, learning=3, evaluating=3)
#: In standard errors; wider than an interval of 95 %, for which the benchmark counts the share.
REACH = 3.5


def diagnosed(case: Case, folder: Path) -> Found:
    learn, evaluate, arm = case.write(folder)
    return by_command([learn], [evaluate], arm, folder / "out")


@pytest.mark.parametrize(
    ("effect", "seed", "bench"),
    [
        ("quadratic_drag", 11, SHORT),
        ("cogging", 15, LONGER),
        ("payload", 17, SHORT),
    ],
)
def test_a_hidden_effect_is_named(effect: str, seed: int, bench: Bench, tmp_path: Path, long: Long) -> None:
    if effect == "cogging" and not long.at_length:
        pytest.skip("a period that is sought takes half a minute: with --long")
    case = draw_case(seed, "one", effect, bench)
    result = score(case.truth, diagnosed(case, tmp_path), REACH)
    assert result["right"], (result, case.truth["effects"])
    assert result["joint"], (result, case.truth["effects"])
    assert result["inside"] == result["asked"] > 0, (result, case.truth["effects"])


@pytest.mark.parametrize("seed", [22])
def test_nothing_is_named_where_nothing_is_hidden(seed: int, tmp_path: Path) -> None:
    case = draw_case(seed, "nothing", bench=SHORT)
    result = score(case.truth, diagnosed(case, tmp_path))
    assert result["verdict"] == "none", result


@pytest.mark.parametrize(("effect", "seed"), [("coupled_drag", 31)])
def test_what_is_in_no_catalogue_is_not_named_but_told_by_its_variables(
    effect: str, seed: int, tmp_path: Path, long: Long
) -> None:
    if not long.at_length:
        pytest.skip("the search of a whole catalogue and of unknown functions: with --long")
    case = draw_case(seed, "outside", effect, SHORT)
    result = score(case.truth, diagnosed(case, tmp_path))
    assert result["right"], (result, case.truth["effects"])
