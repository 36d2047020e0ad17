"""How commands take their arguments: a parser whose mistakes are sentences, help with an example, the version."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module, metadata
from typing import Any

from limbcal.errors import ConfigError
from limbcal.suggestion import did_you_mean

#: How argparse begins what it says of arguments that are not there.
_REQUIRED = "the following arguments are required: "


class Parser(argparse.ArgumentParser):
    """An argument parser whose mistakes join the error family and name what was meant."""

    #: The module whose ``add_arguments`` says what it takes and whose ``EXAMPLE`` shows it, until it is asked.
    module: str | None = None

    def parse_known_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        """Parse as ever, but load the command only now that it was chosen.

        Raises
        ------
        ConfigError
            If something is wrong with the arguments, or one of them is not known.
        """
        if self.module is not None:
            module, self.module = import_module(self.module), None
            module.add_arguments(self)
            self.formatter_class = argparse.RawDescriptionHelpFormatter
            self.epilog = f"example:\n  {module.EXAMPLE}"
        if args is not None:
            self._require_known(args)
        found, rest = super().parse_known_args(args, namespace)
        if rest and self._has_commands and rest[0].startswith("-"):
            self.error(f"{rest[0]} stands before the command, expected it after")
        if rest:
            self.error(f"{rest[0]!r} is one argument too many, expected none of that kind")
        return found, rest

    @property
    def _has_commands(self) -> bool:
        return any(isinstance(action, argparse._SubParsersAction) for action in self._actions)  # noqa: SLF001

    def _require_known(self, arguments: Sequence[str]) -> None:
        """Refuse an unknown option before argparse misses others for its sake."""
        for argument in arguments:
            if argument == "--" or (self._has_commands and not argument.startswith("-")):
                return  # what follows are no options, or a command's own
            option = argument.partition("=")[0]
            if not option.startswith("--") or " " in option:
                continue
            known = [name for name in self._option_string_actions if name.startswith("--")]
            if not any(name.startswith(option) for name in known):
                meant = did_you_mean(option, known)
                if self._has_commands and not meant:
                    return  # perhaps an option of a command
                self.error(f"there is no option {option}{meant or '; expected one of ' + ', '.join(known)}")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse what is none of an argument's choices, with the nearest of them."""
        if action.choices is None or value in action.choices:
            return
        known = [str(choice) for choice in action.choices]
        what = "value" if action.option_strings else "command"
        sentence = f"there is no {what} {value!r}, expected one of {', '.join(known)}"
        named = action if action.option_strings else None
        raise argparse.ArgumentError(named, f"{sentence}{did_you_mean(str(value), known)}")

    def error(self, message: str) -> "None":  # type: ignore[override]
        """Raise a `ConfigError` in place of printing a usage text and leaving."""
        missing = message.removeprefix(_REQUIRED)
        if missing != message:
            message = f"{missing} missing; `{self.prog} --help` says what is expected"
        raise ConfigError(f"{self.prog}: {message}")


class _Version(argparse.Action):
    """``--version``: look the version up only when it is asked for."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        _namespace: argparse.Namespace,
        _values: object,
        _option: str | None = None,
    ) -> None:
        sys.stdout.write(f"{parser.prog.split()[0]} {version()}\n")
        parser.exit()


def version() -> str:
    """Return the version of limbcal that is installed."""
    return metadata.version("limbcal")


def parser_of(prog: str, description: str, package: str, commands: Mapping[str, str]) -> Parser:
    """Return the parser of a program with commands, of which only the chosen one is loaded.

    Parameters
    ----------
    prog, description : str
    package : str
        Where each command has a module of its name (``_`` for ``-``), with ``add_arguments`` and ``EXAMPLE``.
    commands : mapping of str to str
        What each of them does, in a sentence.
    """
    more = f"`{prog} COMMAND --help` says what a command takes, with an example."
    parser = Parser(prog=prog, description=description, epilog=more)
    _add_version(parser)
    chosen = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=Parser)
    for name, sentence in commands.items():
        command = chosen.add_parser(name, help=sentence, description=sentence, parents=[common_options()])
        command.module = f"{package}.{name.replace('-', '_')}"
    return parser


def common_options() -> Parser:
    """Return the parent parser with the options that every command has."""
    parent = Parser(add_help=False)
    parent.add_argument("--json", action="store_true", help="print one JSON document on stdout, nothing else")
    parent.add_argument("--debug", action="store_true", help="show the traceback of an error")
    _add_version(parent)
    return parent


def _add_version(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
