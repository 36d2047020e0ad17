"""An arm whose controller nobody knows but for the form of its law: gains and base parameters at once.

The law's equation is homogeneous (`fitter.controller.law_columns`): all masses, frictions and gains times the same
factor give the same motion. One number that is known fixes the factor; nothing in the motion can.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from arm.base_parameters import BaseParameters
from arm.model import Arm, Estimate, Law
from arm.structural_parameters import structural_parameters
from fitter.controller.closed_loop import polished
from fitter.controller.fixed_parameters import anchors_of, fixed_parameters
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_columns import GAINS, LawColumns, law_columns
from fitter.controller.law_equations import LawEquations, law_equations
from fitter.controller.law_fit import LawFit, equations_gram, fit_law
from fitter.controller.law_forms import LawForm, LawMisfit, law_form, misfit
from fitter.controller.law_sentences import fixed_by, only_together
from fitter.controller.torque_scale import scaled_to_torque
from fitter.data.refilter import refiltered
from fitter.data.standstill import REST_SPEED
from fitter.data.trial import Trial
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import ConfigError, DataError, NotIdentifiable
from limbcal.note import Note, documents

_BIASED = (
    "the simulated motion could not follow the measured one; these are the values of least squares, which noise "
    "draws towards small ones"
)


@dataclass(frozen=True)
class ControllerFit:
    """What was learnt of an arm and of the controller that drives it.

    Attributes
    ----------
    arm : Arm
        With the gains, and with links and friction that have the base parameters.
    law : {"p", "pd", "pda"}
        The form that was assumed: the arm file's.
    gains, parameters : mapping from name to FittedParameter
        Gains of the law, and base parameters. What was given has no standard error, what is only determined
        together with something else is not identifiable by itself.
    fixed_by : str
        Which number the factor rests on.
    only_together : tuple of str
        What the data determines of parameters that it cannot distinguish.
    law_misfit : LawMisfit
    forms : tuple of LawForm
        All forms of the law, from the narrowest on, each with its best gains.
    samples : int
    converged : bool
        False where the simulated motion led nowhere: then these are values of least squares, drawn in by noise.
    notes : tuple of Note
    """

    arm: Arm
    law: Law
    gains: Mapping[str, FittedParameter]
    parameters: Mapping[str, FittedParameter]
    fixed_by: str
    only_together: tuple[str, ...]
    law_misfit: LawMisfit
    forms: tuple[LawForm, ...]
    samples: int
    converged: bool
    notes: tuple[Note, ...] = ()


def fit_controller(
    arm: Arm,
    learn: Sequence[Trial],
    *,
    fixed: Mapping[str, float] | None = None,
    free_gains: Collection[str] | None = None,
    measured_torque: bool = False,
    polish: bool = True,
    rest_speed: float = REST_SPEED,
) -> ControllerFit:
    """Learn gains and base parameters of an arm from its motion, its law's form being known.

    Parameters
    ----------
    arm : Arm
        Its geometry and the form of its law; its values stand for what the data cannot determine.
    learn : sequence of Trial
        Without a ``ref``, each is one motion to an unknown target.
    fixed : mapping from name to value, optional
        What is known: gains such as ``kp1``, or base parameters such as ``I2``. If nothing is, ``kp1`` of the arm
        file is taken for the truth (and one more kp for every part of the arm that has a factor of its own).
    free_gains : collection of str, optional
        The gains that are sought; others are known to be the arm file's. Default: all that are not `fixed`.
    measured_torque : bool
        Trials that have a torque were measured, and that fixes the factor; nothing else may be fixed then.
    polish : bool
        Fit the simulated motion to the measured angles at the end, where these had to be filtered.
    rest_speed : float [rad/s or m/s]
        A joint that is slower is at rest and omitted.

    Raises
    ------
    ConfigError
        If a name is neither a gain of the law nor a base parameter, a kp is fixed to zero, or the law is
        "measured".
    DataError
        If there is no trial, or none has the torque that is asked for.
    NotIdentifiable
        If no joint moved, or what is known doesn't fix the factor.
    """
    if not learn:
        raise DataError("no learning trial; expected at least one")
    law = arm.control.law
    own = next((trial.name for trial in learn if trial.drives is not None), None)
    if own is not None:
        raise ConfigError(
            f"trial {own} says its gains itself, or lets drives go; expected trials under one law of unknown gains"
        )
    if law == "measured":
        raise ConfigError("control.law is 'measured', which has no gains; expected 'pd', 'pda' or 'p'")
    base = structural_parameters(arm)
    widest = law_columns(arm, base)
    columns = widest.narrowed(law)
    known = fixed_parameters(arm, columns, fixed or {}, free_gains)
    if measured_torque and known:
        raise ConfigError(f"{', '.join(known)} and measured torque are given; expected only one to fix the factor")
    trials = [law_equations(arm, base, trial, rest_speed) for trial in refiltered(learn)]
    gram = equations_gram(trials)
    anchors = () if known else anchors_of(arm, columns, trials)
    fixed_values = known | dict(anchors)
    fits: dict[Law, LawFit] = {law: _fitted(arm, base, columns, trials, fixed_values)}
    for other in GAINS:
        if other != law:
            with suppress(NotIdentifiable):  # where what is known says nothing of this form
                fits[other] = _fitted(arm, base, widest.narrowed(other), trials, fixed_values)
    wider = [fits[other] for other in fits if len(GAINS[other]) > len(GAINS[law])]
    if polish and not any(law_form(other, gram).needed for other in wider):
        fits[law] = polished(fits[law], arm, base, learn)  # a form that is not the law's has no best gains
    if measured_torque:
        fits[law] = scaled_to_torque(fits[law], InstrumentalVariables(arm, base, columns), trials)
    forms: dict[Law, LawForm] = {name: law_form(fits[name], gram) for name in GAINS if name in fits}
    fit = fits[law]
    notes = () if fit.converged else (Note("search", _BIASED),)
    parameters = _parameters(fit)
    return ControllerFit(
        arm=_learnt_arm(arm, base, fit, parameters),
        law=law,
        gains={name: parameters[name] for name in columns.gain_names},
        parameters={name: parameters[name] for name in base.names},
        fixed_by=fixed_by(known, dict(anchors), measured_torque),
        only_together=only_together(fit),
        law_misfit=misfit(law, forms, fits),
        forms=tuple(forms.values()),
        samples=sum(len(trial.t) for trial in learn),
        converged=fit.converged,
        notes=notes,
    )


def document(fit: ControllerFit) -> dict[str, object]:
    """Return what was learnt as it stands in the JSON document of ``fitter dynamics --unknown-gains``."""
    return {
        "parameters": {name: p.document() for name, p in (*fit.parameters.items(), *fit.gains.items())},
        "law": fit.law,
        "fixed_by": fit.fixed_by,
        "only_together": list(fit.only_together),
        "law_misfit": {
            "torque_share": list(fit.law_misfit.torque_share),
            "fits": fit.law_misfit.fits,
            "missing": list(fit.law_misfit.missing),
            "sentence": fit.law_misfit.sentence,
        },
        "law_forms": {
            form.law: {
                "torque_share": list(form.torque_share),
                "needed": list(form.needed),
                "not_needed": list(form.not_needed),
                "not_told": list(form.undetermined),
            }
            for form in fit.forms
        },
        "samples": fit.samples,
        "converged": fit.converged,
        "notes": documents(fit.notes),
    }


def _fitted(
    arm: Arm,
    base: BaseParameters,
    columns: LawColumns,
    trials: Sequence[LawEquations],
    known: Mapping[str, float],
) -> LawFit:
    places = {columns.names.index(name): value for name, value in known.items() if name in columns.names}
    return fit_law(arm, base, columns, trials, places)


def _parameters(fit: LawFit) -> dict[str, FittedParameter]:
    std, names = fit.std(), fit.columns.names
    return {
        name: FittedParameter(float(fit.values[k]), float(std[k]), fit.columns.units[k], fit.identifiable(name))
        for k, name in enumerate(names)
    }


def _learnt_arm(arm: Arm, base: BaseParameters, fit: LawFit, parameters: Mapping[str, FittedParameter]) -> Arm:
    learnt = {
        name: Estimate(parameters[name].value, parameters[name].std)
        for k, name in enumerate(base.names)
        if k in fit.free
    }
    return replace(fit.arm(arm, base), base_parameters=learnt)
