"""`fitter compile`: so that no other command has to."""

import argparse

from fitter.commands.kernels import compile_all
from limbcal.command import Document
from limbcal.compilation import said_when_compiling

#: As it stands in the help.
EXAMPLE = "fitter compile"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter compile` takes."""
    parser.set_defaults(action=compile_kernels)


def compile_kernels(_arguments: argparse.Namespace) -> Document:
    """Compile what the commands of `fitter` need."""
    with said_when_compiling("fitter") as compilation:
        compile_all()
    return compilation.document()
