"""The torque fit of the paper's size beside its peers: regressors and searches, in one run and on one machine.

From 1,054,688 samples of the two-joint arm to its eight base parameters: the regressor's rows, their sums, and
1000 generations of 100. Peers are given the same samples. What would take them hours is run as long as it takes to
time it and extrapolated in proportion, to as many samples or evaluations. Times are the processor's, of one
thread: run it with ``OPENBLAS_NUM_THREADS=1``.
"""

import argparse
import os
import sys
import time
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import pinocchio as pin
from figaroh.tools.regressor import RegressorBuilder, RegressorConfig

from arm.arm_file import load_arm
from arm.base_parameters import BaseParameters
from arm.model import Arm, Control, Floats
from arm.regressor import regressor, standard_parameters
from arm.structural_parameters import structural_parameters
from benchmarks.pinocchio_model import pinocchio_model
from benchmarks.searchers import SEARCHES, Cost, Search
from benchmarks.timing import seconds
from benchmarks.torque_fit import GENERATIONS, POPULATION, SAMPLES, bench_trials, breed
from fitter.data.trial import Trial
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.regression_sums.torque_sums import add_up
from fitter.regression_sums.trial_sums import trial_sums
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command, say, to_json

#: Samples of which a peer makes the regressor, one by one.
SOME_SAMPLES = 50_000
#: A search is run for about so long, at least two generations.
CAP_S = 10.0
#: Rows whose residuals for a whole generation stay in the processor's cache.
CHUNK = 1024


@dataclass
class Counted:
    """A cost that counts what it was asked, and keeps the least of it."""

    cost: Cost
    evaluations: int = 0
    least: float = field(default=np.inf)

    def __call__(self, population: Floats) -> Floats:
        """Return the costs of a population."""
        values = self.cost(population)
        self.evaluations += len(values)
        self.least = min(self.least, float(values.min()))
        return values


@dataclass(frozen=True)
class Task:
    """The fit that everybody is given.

    Attributes
    ----------
    arm : Arm
    base : BaseParameters
    trials : list of Trial
    problem : TorqueProblem
        Made of the sums.
    rows : (n_sample * n_joint, n_base)
        The regressor's rows of all samples.
    tau : (n_sample * n_joint,)
    """

    arm: Arm
    base: BaseParameters
    trials: list[Trial]
    problem: TorqueProblem
    rows: Floats
    tau: Floats

    def on_samples(self, unit: Floats) -> Floats:
        """Return eq. (9) for a generation of unit boxes, each individual held against every sample by itself."""
        return np.array([np.sum((self.rows @ genes - self.tau) ** 2) for genes in self._genes(unit)])

    def in_products(self, unit: Floats) -> Floats:
        """Return the same by matrix products that stay in the cache: as fast as samples can be had in numpy."""
        genes, cost = np.ascontiguousarray(self._genes(unit).T), np.zeros(len(unit))
        for begin in range(0, len(self.rows), CHUNK):
            residual = self.rows[begin : begin + CHUNK] @ genes
            residual -= self.tau[begin : begin + CHUNK, None]
            cost += np.einsum("ij,ij->j", residual, residual)
        return cost

    def on_sums(self, unit: Floats) -> Floats:
        """Return the same from the sums."""
        return self.problem.cost(self._genes(unit))

    def _genes(self, unit: Floats) -> Floats:
        lower, upper = self.problem.bounds()
        return lower + unit * (upper - lower)


def make_task(samples: int) -> Task:
    """Make the motion, its noisy torque, and all that the searches are given."""
    law = load_arm("dd-arm")
    arm = replace(law, control=Control())
    base, trials = structural_parameters(arm), bench_trials(law, samples)
    prior = base.combination @ standard_parameters(arm)
    problem = torque_problem(add_up([trial_sums(arm, base, trial, 0.0) for trial in trials]), prior)
    rows = [regressor(arm, t.q, t.dq, t.ddq)[..., base.independent][t.dq != 0.0] for t in trials]
    torques = [t.tau[t.dq != 0.0] for t in trials if t.tau is not None]
    return Task(arm, base, trials, problem, np.concatenate(rows), np.concatenate(torques))


def ours(task: Task) -> dict[str, float]:
    """Return how long the parts of our own way take [s]."""
    prior = task.base.combination @ standard_parameters(task.arm)

    def reduce() -> object:
        return add_up([trial_sums(task.arm, task.base, trial, 0.0) for trial in task.trials])

    q, dq, ddq, share = _some(task)

    def rows() -> object:
        return regressor(task.arm, q, dq, ddq)

    search = partial(breed, task.problem.sums, prior)
    return {
        "regressor": share * seconds(rows),
        "regressor and sums": seconds(reduce),
        "search": seconds(search),
        "samples to parameters": seconds(lambda: (reduce(), search())),
    }


def regressors(task: Task) -> dict[str, float]:
    """Return how long peers take for the regressor of all samples [s], from some of them."""
    model, (q, dq, ddq, share) = pinocchio_model(task.arm), _some(task)
    data = model.createData()

    def loop() -> None:
        for k in range(len(q)):
            pin.computeJointTorqueRegressor(model, data, q[k], dq[k], ddq[k])

    robot = pin.RobotWrapper(model)
    builder = RegressorBuilder(robot, RegressorConfig(has_friction=True))
    settings = {"act_idxv": list(range(task.arm.n_joint))}
    built = builder.build_basic_regressor(q, dq, ddq, settings)
    _require_same_torque(task, built, q, dq, ddq)
    return {
        "pinocchio computeJointTorqueRegressor, Python loop": share * seconds(loop),
        "figaroh RegressorBuilder": share
        * seconds(lambda: builder.build_basic_regressor(q, dq, ddq, settings), repeats=2),
    }


def _some(task: Task) -> tuple[Floats, Floats, Floats, float]:
    """Return the motion of some samples, and how many times as many there are in all."""
    trial = task.trials[0]
    q, dq, ddq = (values[:SOME_SAMPLES] for values in (trial.q, trial.dq, trial.ddq))
    return q, dq, ddq, sum(len(t.q) for t in task.trials) / len(q)


def _require_same_torque(task: Task, built: Floats, q: Floats, dq: Floats, ddq: Floats) -> None:
    """Make sure that peers are asked the same question: both regressors span the same torques."""
    rows = regressor(task.arm, q, dq, ddq)[..., task.base.independent]
    mine = np.concatenate([rows[:, joint] for joint in range(task.arm.n_joint)])[::7]
    inside = built[::7] @ np.linalg.lstsq(built[::7], mine)[0]
    if not np.allclose(inside, mine, atol=1e-6 * np.abs(mine).max()):
        raise AssertionError("the peers' regressor is of another arm")


def search_seconds(
    search: Search, cost: Cost, genes: int, generations: int, cap_s: float
) -> tuple[float, int, float]:
    """Run a search for no longer than it takes to time it.

    Returns
    -------
    seconds : float
        For 1000 generations of 100, extrapolated in proportion to the evaluations where it was run for fewer.
    evaluations : int
        How many it was run for.
    least : float
        The least cost that it found.
    """
    count = 2
    while True:
        counted = Counted(cost)
        begin = time.process_time()
        search(counted, genes, POPULATION, count)
        took = time.process_time() - begin
        if count >= generations or took > 0.3 * cap_s:
            return took * POPULATION * GENERATIONS / counted.evaluations, counted.evaluations, counted.least
        count = min(generations, max(count + 1, int(count * 0.8 * cap_s / max(took, 1e-3))))


def measure(samples: int = SAMPLES, cap_s: float = CAP_S) -> dict[str, object]:
    """Measure everything side by side."""
    task = make_task(samples)
    genes, optimum = len(task.problem.free), task.problem.rest
    mine = ours(task)
    searches: dict[str, dict[str, object]] = {}
    for name, (_, search) in SEARCHES.items():
        say(f"timing {name}")
        found: dict[str, object] = {}
        costs = {"one_by_one": task.on_samples, "products": task.in_products, "sums": task.on_sums}
        for kind, cost in costs.items():
            patience_s = 3.0 * cap_s if kind == "sums" else cap_s  # on sums all can be run to the end
            took, evaluations, least = search_seconds(search, cost, genes, GENERATIONS, patience_s)
            found[kind] = {"seconds": took, "evaluations": evaluations, "excess": least / optimum - 1.0}
        searches[name] = found
    return {
        "samples": samples,
        "some_samples": SOME_SAMPLES,
        "parameters": genes,
        "blas_threads": os.environ.get("OPENBLAS_NUM_THREADS"),
        "ours": mine,
        "regressors": regressors(task),
        "searches": searches,
    }


def show(options: argparse.Namespace) -> Document:
    """Measure, and print what was found."""
    found = measure(options.samples, options.cap)
    say(to_json(found))
    return found


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.peers", description=__doc__, parents=[common_options()])
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--cap", type=float, default=CAP_S, help=f"seconds for each search ({CAP_S:g})")
    parser.set_defaults(action=show)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
