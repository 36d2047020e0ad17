"""The error family of limbcal.

LimbcalError
├── ConfigError      a config, arm file or argument is wrong              exit 2
├── DataError        a measurement file cannot be used as it is           exit 2
├── ProtocolError    a frame or message breaks the protocol               exit 2
├── DeviceError      a device, socket or disk failed                      exit 3
├── NotIdentifiable  the data cannot answer the question asked            exit 4
├── NotConverged     the search ended before it found an answer           exit 4
└── Unusable         there is an answer, but nobody can act on it         exit 4

The text of an error is one sentence: where (file, line or field), what was found, what was expected.
"""

from collections.abc import Mapping, Sequence


class LimbcalError(Exception):
    """Base of everything that limbcal raises on purpose.

    Attributes
    ----------
    exit_code : int
    document : mapping, optional
        The JSON document of what there is all the same; ``--json`` prints it before the command ends.
    """

    exit_code = 2
    document: Mapping[str, object] | None = None


class ConfigError(LimbcalError):
    """One or several mistakes in a config, an arm file or the arguments.

    Parameters
    ----------
    mistakes : str or sequence of str
        One sentence a mistake, each naming its field.
    """

    def __init__(self, mistakes: str | Sequence[str]) -> None:
        self.mistakes = [mistakes] if isinstance(mistakes, str) else list(mistakes)
        super().__init__("\n".join(self.mistakes))


class DataError(LimbcalError):
    """A measurement cannot be used as it is."""


class ProtocolError(LimbcalError):
    """A frame, message or recording breaks the protocol."""


class DeviceError(LimbcalError):
    """A device, socket or disk failed."""

    exit_code = 3


class NotIdentifiable(LimbcalError):  # noqa: N818 - the name says what the data is, as in the contract
    """The data cannot answer the question asked."""

    exit_code = 4


class NotConverged(LimbcalError):  # noqa: N818
    """The search ended before it found an answer."""

    exit_code = 4


class Unusable(LimbcalError):  # noqa: N818
    """There is an answer, written and printed, but nobody can act on it.

    Parameters
    ----------
    reasons : str or sequence of str
        One sentence each: what is wrong with the answer, and the likely cause.
    document : mapping, optional
        The answer as ``--json`` prints it.
    """

    exit_code = 4

    def __init__(self, reasons: str | Sequence[str], document: Mapping[str, object] | None = None) -> None:
        self.document = document
        super().__init__(reasons if isinstance(reasons, str) else "\n".join(reasons))
