"""What `fitter dynamics` says at the terminal."""

from collections.abc import Mapping, Sequence

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from arm.model import Arm
from fitter.controller.controller import ControllerFit
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.evaluation import Score
from fitter.dynamics.free_swing import FreeSwing
from fitter.dynamics.identifiability import Identifiability
from fitter.dynamics.usability import percent
from fitter.report.compared import Compared
from fitter.report.parameter_table import parameter_table
from fitter.search.fitted_parameter import FittedParameter
from limbcal.command import say, show
from limbcal.note import sentences

_ROLES = {"learn": "learning", "evaluate": "evaluating"}


def say_fit(
    fit: DynamicsFit,
    compared: Sequence[Compared],
    learn: Score | None,
    evaluate: Score | None,
    revealed: Identifiability,
) -> None:
    """Print the parameters of a fit, how well it does, and what the user should know of it."""
    title = f"{fit.arm.name}: {fit.samples} samples, condition {fit.condition_number:.3g}, by {fit.objective}"
    show(parameter_table(title, fit.parameters, {c.name: c.parameters for c in compared}))
    _say_scores(fit.arm, {"learn": learn, "evaluate": evaluate})
    for sentence in (*sentences(fit.notes), *revealed.sentences()):
        say(sentence)


def say_controller(fit: ControllerFit, scores: Mapping[str, Score | None]) -> None:
    """Print gains and parameters, what sets their scale, and whether the law is of this form at all."""
    title = f"{fit.arm.name}: {fit.samples} samples, gains of law {fit.law!r} learnt along"
    show(parameter_table(title, {**fit.gains, **fit.parameters}, {}))
    _say_scores(fit.arm, scores)
    for sentence in (fit.fixed_by, *fit.only_together, fit.law_misfit.sentence, *sentences(fit.notes)):
        say(sentence)


def say_ratios(swing: FreeSwing) -> None:
    """Print what a free swing tells: ratios, without springs at the joints, with them, and with stiff ends."""
    table = Table(title=Text("ratios, with 95 % intervals"), title_justify="left", box=box.SIMPLE_HEAD)
    models = ("without springs", "with springs", *(["and stiff ends"] if swing.ends else []))
    for heading in ("ratio", *models, "unit"):
        table.add_column(heading, justify="right" if heading in models else "left", overflow="fold")
    for one in swing.ratios:
        found = (one.rigid, one.sprung, one.stiffening)[: len(models)]
        table.add_row(*map(Text, (one.name, *map(_with_reach, found), one.sprung.unit)))
    show(table)
    for one in swing.ratios:
        if one.is_spring and one.is_significant:
            say(f"{one.name}: something elastic turns this joint, too; expected ratios {' '.join(models[1:])}")
    for end in swing.ends:
        way = "forwards" if end.side > 0.0 else "backwards"
        say(
            f"joint {end.joint + 1} stiffens {way} towards {end.angle_rad:.3g} rad, as tissue does at the end of "
            f"a range; expected ratios {' '.join(models[1:])}"
        )


def _with_reach(one: FittedParameter | None) -> str:
    return f"{one.value:.4g} ± {one.half_width:.2g}" if one is not None and one.identifiable else "-"


def say_compared(arm: Arm, compared: object) -> None:
    """Print how well other arms do on the same trials; they have the joints of ``arm``."""
    assert isinstance(compared, dict)
    for name, fields in compared.items():
        for role, title in _ROLES.items():
            torque = fields["torque_rms_N_m"][role]
            if torque is not None:
                show(f"{name}, {title}: {_torque_rms(arm, torque)}")


def _say_scores(arm: Arm, scores: Mapping[str, Score | None]) -> None:
    for role, s in scores.items():
        if s is not None:
            shares = ", ".join(map(percent, s.explained))
            torque = _torque_rms(arm, s.torque_rms_N_m)
            show(f"{_ROLES[role]}: {torque}, {shares} of the power explained; {_angles(s)}")


def _torque_rms(arm: Arm, rms: Sequence[float]) -> str:
    """Return the rms of each joint's torque, or force where it slides, with its unit."""
    units = ["N·m" if joint.type == "revolute" else "N" for joint in arm.joints]
    if len(set(units)) == 1:
        what = "torque" if units[0] == "N·m" else "force"
        return f"{what} rms {', '.join(f'{value:.4g}' for value in rms)} {units[0]} a joint"
    each = ", ".join(f"{value:.4g} {unit}" for value, unit in zip(rms, units, strict=True))
    return f"torque rms {each}"


def _angles(s: Score) -> str:
    """Return how far simulated angles are off, in words where a simulation ran away."""
    if not np.isfinite(s.angle_max_deg):
        return "the simulated motion runs away" if np.isinf(s.angle_max_deg) else "no joint turns"
    return f"simulated angle off by {s.angle_mean_deg:.3g}° mean, {s.angle_max_deg:.3g}° max"
