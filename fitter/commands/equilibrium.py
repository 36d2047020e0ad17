"""`fitter dynamics --unknown-gains` on a person: law, gains and targets unknown, ratios up to scale."""

import argparse
from collections.abc import Sequence

from rich import box
from rich.table import Table
from rich.text import Text

from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.controller.equilibrium_ratios import EquilibriumFit, EquilibriumRatio, equilibrium_ratios
from fitter.data.trial import Trial
from fitter.dynamics.written import save_calibrated
from fitter.ground.floating_base import floating_base
from limbcal.command import Document, say, show
from limbcal.digits import with_half_width
from limbcal.errors import ConfigError
from limbcal.note import Note, documents, sentences
from protocol.tables.files import expand

_STANDS = (
    "frame 0 is taken to stand: a base that is carried adds inertial forces, which pass for the equilibrium "
    "trajectory where they are slow and leave no ratio where they are not"
)


def nothing_is_known(arm: Arm, trials: Sequence[Trial]) -> bool:
    """Say whether neither a law is assumed nor a torque, target or gain was recorded."""
    recorded = (one for trial in trials for one in (trial.tau, trial.ref, trial.drives))
    return arm.control.law == "measured" and all(one is None for one in recorded)


def up_to_scale(arguments: argparse.Namespace, arm: Arm, learn: Sequence[Trial]) -> Document:
    """Find ratios, write the arm as it was, and say what the ratios are worth.

    Raises
    ------
    ConfigError
        If an option asks for a scale, or nothing can drive the arm's base.
    """
    for given, option in ((arguments.fix, "--fix"), (arguments.evaluate, "--evaluate")):
        if given:
            raise ConfigError(
                f"{option} needs a law with a scale, and arm {arm.name} has no [control]; expected ratios alone"
            )
    if _floats(arm):
        raise ConfigError(
            f"nothing drives the floating base of arm {arm.name}, so no law holds there; expected --ground, the "
            "forces of plates, instead of --unknown-gains"
        )
    fit = equilibrium_ratios(arm, learn, arguments.seed)
    save_calibrated(arm, structural_parameters(arm), {}, arguments.out)
    notes = [Note("assumed", _STANDS)] if arm.base is not None and arm.base.segment is not None else []
    _say(arm, fit)
    for sentence in (*fit.sentences(), *sentences(notes)):
        say(sentence)
    say(f"{arguments.out} keeps the masses that the arm had: ratios set none")
    if arguments.report is not None:
        files = expand([*arguments.learn])
        from fitter.report.equilibrium_page import write_equilibrium_page

        write_equilibrium_page(arguments.report, arm.name, fit, [arguments.arm, *files])
        show(f"report: {arguments.report}")
    return fit.document() | {"notes": documents(notes)}


def _floats(arm: Arm) -> bool:
    try:
        floating_base(arm)
    except ConfigError:
        return False
    return True


def _say(arm: Arm, fit: EquilibriumFit) -> None:
    if not fit.ratios:
        return
    table = Table(title=Text(f"{arm.name}, up to scale"), title_justify="left", box=box.SIMPLE_HEAD)
    for heading in ("ratio", "value, 95 % interval", "unit"):
        table.add_column(heading, overflow="fold")
    for one in fit.ratios:
        table.add_row(*map(Text, (one.name, _interval(one), one.unit)))
    show(table)


def _interval(one: EquilibriumRatio) -> str:
    if one.ci95 is None:
        return "not identified"
    low, high = one.ci95
    return " ± ".join(with_half_width((low + high) / 2.0, (high - low) / 2.0))
