"""`fitter dynamics` from sums, saved ones or those of many files: the motion itself is never held."""

import argparse

import numpy as np

from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.commands.dynamics_said import say_compared, say_fit
from fitter.commands.options import bounds_of, fixed_of
from fitter.commands.sums import reduced
from fitter.commands.trial_sets import Filters, evaluating, motions_of, notes_of, require_apart, with_notes
from fitter.data.standstill import REST_SPEED
from fitter.data.trial import Role, Trial
from fitter.data.trials import to_trials
from fitter.dynamics.consistency import made_possible, with_warnings
from fitter.dynamics.dynamics_fit import document
from fitter.dynamics.errors_of_motions import known_by_motions
from fitter.dynamics.evaluation import score
from fitter.dynamics.identifiability import report
from fitter.dynamics.known_effects import without_effects
from fitter.dynamics.torque_search import fit_sums
from fitter.dynamics.usability import next_to_nothing
from fitter.dynamics.written import determined_by_data, save_calibrated
from fitter.regression_sums.saved_sums import ArmSums, add_sums, equation_of, is_sums, load_sums
from fitter.report.compared import load_compared
from limbcal.command import Document, say_notes
from limbcal.errors import ConfigError, Unusable
from limbcal.note import Note
from protocol.tables.files import RECORDINGS, expand


def dynamics_from_sums(arguments: argparse.Namespace, arm: Arm) -> Document:
    """Learn from sums, saved ones or those of many files, and write the calibrated arm.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of `fitter dynamics`.
    arm : Arm

    Raises
    ------
    ConfigError
        If something is asked for that sums cannot answer, or they are of another equation.
    Unusable
        If next to nothing is explained.
    """
    if arguments.report is not None:
        raise ConfigError("--report shows motions, which sums no longer hold; expected motions to learn from")
    if arguments.payload is not None:
        raise ConfigError("sums no longer hold trials; expected motions to learn from with --payload")
    if arguments.objective not in ("auto", "torque") or arguments.unknown_gains or arguments.no_torque:
        raise ConfigError("sums know of the torque only: expected --objective torque, and no other way to learn")
    if without_effects(arm, ())[0] is not arm:
        raise ConfigError(
            f"arm {arm.name!r} has [[effect]] or air drag, whose torque is in the sums; expected motions to learn "
            "from, or an arm without them"
        )
    require_apart(arguments.learn, arguments.evaluate)
    compared = load_compared(arguments.compare, arm)
    saved, notes, filters = _sums(arguments, arm)
    evaluate = _evaluating(arguments, arm, filters)
    base = structural_parameters(arm)
    fit = fit_sums(
        arm,
        base,
        saved.sums,
        seed=arguments.seed,
        population=arguments.population,
        generations=arguments.generations,
        bounds=bounds_of(arguments.bounds),
        fixed=fixed_of(arguments.fix),
        method=arguments.method,
    )
    tracked = any(path.suffix.lower() in RECORDINGS for path in expand(arguments.learn))
    fit = known_by_motions(fit, tracked)
    fit = made_possible(fit) if arguments.physical else with_warnings(fit)
    evaluated = score(fit.arm, evaluate, arguments.horizon) if evaluate else None
    save_calibrated(fit.arm, base, determined_by_data(fit), arguments.out)
    revealed = report(arm, base, fit.problem)
    say_fit(fit, compared, None, evaluated, revealed)
    answer = document(fit, None, evaluated) | {"identifiability": revealed.document()}
    values = np.array([fit.parameters[name].value for name in base.names])
    rms = answer["torque_rms_N_m"]
    assert isinstance(rms, dict)
    rms["learn"] = saved.sums.rms(values).tolist()
    explained = answer["explained"]
    assert isinstance(explained, dict)
    explained["learn"] = saved.sums.explained(values).tolist()
    if compared:
        answer["compared"] = {c.name: c.document([], evaluate, arguments.horizon) for c in compared}
        say_compared(arm, answer["compared"])
    answer = with_notes(answer, (*notes, *notes_of(evaluate)))
    if reasons := next_to_nothing(explained, arm):
        raise Unusable(reasons, answer)
    return answer


def _sums(arguments: argparse.Namespace, arm: Arm) -> tuple[ArmSums, tuple[Note, ...], Filters]:
    """Return the sums, what was done to get there, and the corners of both filters, None where sums do not say."""
    held = [is_sums(path) for path in arguments.learn]
    if all(held):
        saved = add_sums([load_sums(path) for path in arguments.learn], [str(path) for path in arguments.learn])
        saved.require(equation_of(arm, REST_SPEED), str(arguments.learn[0]))
        return saved, (), (arguments.cutoff_hz, None)
    if any(held):
        raise ConfigError(f"{arguments.learn[held.index(True)]}: sums among motions, expected one or the other")
    omitted: Role | None = None if arguments.evaluate else "evaluate"  # as in `fitter.commands.trial_sets`
    reduction = reduced(arguments, arm, arguments.learn, omitted)
    say_notes(reduction.notes)
    return reduction.saved, reduction.notes, (reduction.cutoff_hz, reduction.band_hz)


def _evaluating(arguments: argparse.Namespace, arm: Arm, filters: Filters) -> list[Trial]:
    """Return the trials of ``--evaluate``, or else those that recordings hold back themselves."""
    if arguments.evaluate:
        held_back = motions_of(arguments, arm, arguments.evaluate)
    else:
        recordings = [path for path in expand(arguments.learn) if path.suffix.lower() in RECORDINGS]
        held_back = evaluating(motions_of(arguments, arm, recordings)) if recordings else []
    return to_trials(held_back, arguments.rate_hz, *filters) if held_back else []
