"""`limbplay compile`: so that no other command has to."""

import argparse

from limbcal.command import Document
from limbcal.compilation import said_when_compiling
from playback.kernels import compile_all

#: As it stands in the help.
EXAMPLE = "limbplay compile"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay compile` takes."""
    parser.set_defaults(action=compile_kernels)


def compile_kernels(_arguments: argparse.Namespace) -> Document:
    """Compile what the commands of `limbplay` need."""
    with said_when_compiling("limbplay") as compilation:
        compile_all()
    return compilation.document()
