"""The verdict on a search, from errors that are worked by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Effect
from fitter.marker_diagnosis import marker_finding
from fitter.marker_diagnosis.marker_finding import NEXT, diagnose_markers
from fitter.marker_diagnosis.marker_hypotheses import Suspicion
from fitter.marker_diagnosis.marker_search import MarkerCause, MarkerSearch

LABELS = ("a", "b", "c")


def errors(squares_mm2, mean_mm=(0.0, 0.0)):
    """Return a trial of two markers and two seconds, ten frames each."""
    mean = np.zeros((2, 3))
    mean[:, 0] = 1e-3 * np.array(mean_mm)
    y = np.zeros((20, 2, 3))
    return SimpleNamespace(names=("M0", "M1"), squares=1e-6 * np.array(squares_mm2, dtype=float), y=y, mean=mean)


def moved(marker, evidence, trials, parameters=()):
    effect = Effect("marker_moved", {"x_m": 0.02, **dict(parameters)}, markers=(marker,))
    return Suspicion(effect, {"x_m": 0.001}, evidence, trials)


MOVED = moved("M0", 30.0, (2, 3), {"trials": [2, 3]})
OTHER = moved("M1", 10.0, (1,))
SLID = Suspicion(
    Effect("soft_tissue", {"joint": 4, "x_m_rad": 0.01}, markers=("M0",)), {"x_m_rad": 0.002}, 29.0, (2, 3)
)
BEFORE = [
    errors([[20.0, 20.0], [20.0, 20.0]]),
    errors([[320.0, 20.0], [320.0, 20.0]], (4.0, 0.0)),
    errors([[180.0, 20.0], [720.0, 20.0]], (3.0, 0.0)),
]
AFTER = [
    errors([[20.0, 20.0], [20.0, 20.0]]),
    errors([[80.0, 20.0], [80.0, 20.0]]),
    errors([[90.0, 20.0], [90.0, 20.0]]),
]


@pytest.fixture
def diagnosed(monkeypatch):
    def of(causes=(), first=(MOVED, OTHER), wander=0.5, before=BEFORE, after=AFTER):
        search = MarkerSearch(
            tuple(causes), list(first), before, after, SimpleNamespace(mean=wander), SimpleNamespace(name="arm")
        )
        monkeypatch.setattr(marker_finding, "search_markers", lambda *_: search)
        return diagnose_markers(search.arm, [None, None], [None], LABELS)

    return of


def test_a_cause_has_its_numbers_trials_and_what_it_takes_away(diagnosed):
    found = diagnosed([MarkerCause(MOVED, (), 0.9)])
    (cause,) = found.causes
    assert found.verdict == "named" and found.complete
    assert (cause.effect, cause.markers, cause.trials, cause.support) == ("marker_moved", ("M0",), ("b", "c"), 0.9)
    number = cause.parameters["x_m"]
    assert (number.value, number.std, number.unit) == (0.02, 0.001, "m") and "trials" not in cause.parameters
    assert cause.takes_away["learn"] == pytest.approx(1.0 - 200.0 / 680.0)
    assert cause.takes_away["evaluate"] == pytest.approx(1.0 - 180.0 / 900.0)
    assert found.next_experiment == NEXT["marker_moved"]


def test_errors_are_judged_on_the_evaluating_trials(diagnosed):
    found = diagnosed([MarkerCause(MOVED, (), 0.9)])
    assert found.before == {"M0": pytest.approx(np.sqrt(45.0)), "M1": pytest.approx(np.sqrt(2.0))}
    assert found.after["M0"] == pytest.approx(3.0)
    assert found.rms_mm == (pytest.approx(np.sqrt(940.0 / 40.0)), pytest.approx(np.sqrt(220.0 / 40.0)))
    assert found.gain == pytest.approx(1.0 - 220.0 / 940.0)
    low, high = found.ci95  # blocks: 200 to 110, and 740 to 110
    assert low == pytest.approx(1.0 - 110.0 / 200.0) and high == pytest.approx(1.0 - 110.0 / 740.0)
    assert [name for name, *_ in found.by_trial] == list(LABELS)
    assert found.by_trial[1][1][0] == pytest.approx(np.sqrt(32.0)) and found.by_trial[1][2][0] == pytest.approx(
        np.sqrt(8.0)
    )


def test_candidates_share_the_likelihood_and_the_errors(diagnosed):
    found = diagnosed([MarkerCause(MOVED, (), 0.9)])
    first, second = found.candidates
    assert first.support == pytest.approx(
        1.0 / (1.0 + np.exp(-20.0))
    ) and first.support + second.support == pytest.approx(1.0)
    assert first.gain == 1.0 and second.gain == 0.0
    assert [one.support for one in diagnosed().candidates] == [0.0, 0.0]


def test_an_equal_makes_it_ambiguous(diagnosed):
    found = diagnosed([MarkerCause(MOVED, (SLID,), 0.6)])
    assert found.verdict == "ambiguous" and found.confusable == [("marker_moved", "soft_tissue")]
    itself, equal = found.causes
    assert equal.support == pytest.approx(0.6 * np.exp(-1.0)) and equal.takes_away == {} and itself.support == 0.6
    assert equal.parameters["x_m_rad"].unit == "m/rad" and equal.trials == ()
    assert (equal.parameters["joint"].value, equal.parameters["joint"].std, equal.parameters["joint"].unit) == (
        4.0,
        None,
        "1",
    )


@pytest.mark.parametrize(("wander", "verdict"), [(1.0, "none"), (1.01, "unexplained")])
def test_without_causes_markers_wander_or_do_not(diagnosed, wander, verdict):
    found = diagnosed(wander=wander)
    assert found.verdict == verdict and found.causes == [] and found.complete is (verdict == "none")
    assert found.next_experiment.startswith("nothing" if verdict == "none" else "record a trial")


def test_nothing_measured_is_no_gain(diagnosed):
    none = [errors(np.zeros((2, 2)))] * 3
    found = diagnosed([MarkerCause(MOVED, (), 0.9)], before=none, after=none)
    assert found.causes[0].takes_away == {"learn": 0.0, "evaluate": 0.0} and found.candidates[0].gain == 0.0
    unseen = [replace_y(one) for one in BEFORE]
    assert np.isnan(diagnosed(before=unseen, after=unseen).before["M0"])


def replace_y(one):
    return SimpleNamespace(**{**vars(one), "y": np.full_like(one.y, np.nan)})
