"""`fitter effects`: what a simulation may get wrong, and by what each effect is known."""

import argparse

from rich.markup import escape
from rich.table import Table

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind, Parameter
from limbcal.command import Document, show

#: As it stands in the help.
EXAMPLE = "fitter effects"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter effects` takes: nothing of its own."""
    parser.set_defaults(action=list_effects)


def list_effects(arguments: argparse.Namespace) -> Document:
    """List the catalogue of effects."""
    kinds = list(catalogue().values())
    if not arguments.json:
        table = Table(show_lines=True, title="what a simulation may get wrong, because …", title_justify="left")
        table.add_column("effect", no_wrap=True)
        table.add_column("what it is, in which numbers, and what it can be taken for")
        for kind in kinds:
            numbers = "\n".join(_words(parameter) for parameter in kind.parameters)
            about = f"{kind.sentence}\n[dim]{numbers}[/]"
            others = f"\n[dim]or {', '.join(kind.taken_for)}?[/]" if kind.taken_for else ""
            table.add_row(f"{kind.name}\n[dim]{kind.acts_on}[/]", about + others)
        show(table)
    return {"effects": [_entry(kind) for kind in kinds]}


def _words(parameter: Parameter) -> str:
    unit = "" if parameter.unit == "1" else f" [{parameter.unit}]"
    return f"{parameter.name}{escape(unit)}{', if wanted' if parameter.optional else ''}"


def _entry(kind: EffectKind) -> Document:
    return {
        "name": kind.name,
        "sentence": kind.sentence,
        "place": kind.place,
        "acts_on": kind.acts_on,
        "parameters": [
            {
                "name": parameter.name,
                "unit": parameter.unit,
                "low": parameter.low,
                "high": parameter.high,
                "linear": parameter.linear,
                "optional": parameter.optional,
            }
            for parameter in kind.parameters
        ],
        "taken_for": kind.taken_for,
    }
