"""A gain that is far off is found, though no slope leads there."""

from pathlib import Path

import pytest

from arm.arm_file import load_arm
from benchmarks.hidden_arms.cases import draw_case
from benchmarks.hidden_arms.hiding import Bench
from fitter.data.motions import read_motions
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of, reweighted
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import Starts, fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.screening import screen
from protocol.tables.columns import ColumnMap


@pytest.mark.parametrize(("seed", "bench"), [(5, Bench(trial_s=3.0, learning=3, evaluating=3)), (220003, Bench())])
def test_it_is_found_from_afar(seed: int, bench: Bench, tmp_path: Path) -> None:
    """Of three joints: of two only the ratio shows, and one gain passes for the inverse of the other."""
    case = draw_case(seed, "one", "gain_error", bench)
    (effect,) = case.truth["effects"]
    factor = effect["entries"][0]["parameters"]["factor"]
    assert not 0.75 < factor < 1.33
    learn, evaluate, arm_file = case.write(tmp_path)
    arm = load_arm(arm_file)
    sets = [read_motions(path, arm.n_joint, ColumnMap(), None, ("q", "tau", "ref")) for path in (learn, evaluate)]
    learning, evaluating = (to_trials(some) for some in sets)
    regression = regression_of(arm, run_of(arm, learning, evaluating))
    gains = [one for one in hypotheses(arm.n_joint, (), driven=True) if one.kind.name == "gain_error"]
    for _ in range(2):  # and once more, weighed by the noise that there is under the right gain
        best = screen(regression, fitted(regression, Model()), gains, Starts())[0]
        assert [j + 1 for j in best.hypothesis.joints] == effect["joints"]
        assert best.model.psi[-1][0] == pytest.approx(factor, rel=0.05)
        assert best.squares.sum() < 2.0 * sum(
            regression.weighting.n_effective(motion) for motion in regression.motions
        )
        own = reweighted(
            regression.equations, regression.weighting, best.model, best.x, regression.motions, regression.noisier
        )
        regression = regression.weighted_by(own)
        regression.own_share = regression.noise_share(best.model, best.x)
