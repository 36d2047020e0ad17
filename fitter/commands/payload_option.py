"""`fitter dynamics --payload KG:TRIALS`: loads of known mass."""

import argparse
import math
from collections.abc import Sequence

from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.known_load import KnownLoad, by_factors, factor_notes, torque_factors, without_load
from limbcal.errors import ConfigError
from limbcal.note import Note

Trials = Sequence[Trial]

#: No run has a trial of a higher number: the catalogue's bound (`arm.effects.payload`).
_LAST = 1_000_000


def add_payload(parser: argparse.ArgumentParser) -> None:
    """Add the option."""
    parser.add_argument(
        "--payload",
        type=known_load,
        metavar="KG:TRIALS",
        help="a known mass at the tip in some trials, as 0.5:2,4-6: counted from 1, those of --evaluate last; "
        "needs measured torque",
    )


def known_load(text: str) -> KnownLoad:
    """Read a load such as ``0.5:2,4-6``."""
    mass, colon, trials = text.partition(":")
    numbers: set[int] = set()
    try:
        mass_kg = float(mass)
        for part in trials.split(","):
            first, dash, last = part.partition("-")
            numbers |= set(range(int(first), min(int(last if dash else first), _LAST) + 1))
    except ValueError:
        mass_kg = math.nan
    if not (colon and numbers and 0.0 < mass_kg < math.inf and min(numbers) >= 1):
        raise argparse.ArgumentTypeError(f"{text!r} is no load, expected one such as 0.5:2,4-6")
    return KnownLoad(mass_kg, frozenset(numbers))


def unloaded(
    load: KnownLoad, arm: Arm, learn: Trials, evaluate: Trials
) -> tuple[list[Trial], list[Trial], dict[str, object], list[Note]]:
    """Return trials as of the bare arm, what stands of the load in the document, and what is said.

    Raises
    ------
    ConfigError
        If a law drives the arm: its torque was never measured.
    DataError
        If there is no such trial, or one has no measured torque.
    """
    if arm.control.law != "measured":
        raise ConfigError("--payload needs measured torque, expected an arm of law 'measured' and columns tau1…")
    factors = torque_factors(arm, structural_parameters(arm), learn, load)
    bare = without_load(arm, by_factors([*learn, *evaluate], factors), load)
    document: dict[str, object] = {
        "mass_kg": load.mass_kg,
        "trials": sorted(load.trials),
        "torque_factor": [one.document() | {"ci95": one.ci95} for one in factors],
    }
    return bare[: len(learn)], bare[len(learn) :], {"payload": document}, factor_notes(factors)
