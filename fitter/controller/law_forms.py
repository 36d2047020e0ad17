"""Which form of the law a motion supports: (5), (6) or (7)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from arm.model import Floats, Law
from fitter.controller.law_columns import EQUATIONS, GAINS, TERMS, LawColumns
from fitter.controller.law_fit import LawFit
from limbcal.digits import with_interval

#: Significance level of the chi-squared test that a gain differs from zero.
_SIGNIFICANCE = 1e-3
#: Least rms torque of a term that counts, as a fraction of the law's in its joint: less may be the arm's own.
_LEAST_TORQUE = 1e-2


@dataclass(frozen=True)
class LawForm:
    """One form of the law, with its best gains.

    Attributes
    ----------
    law : {"p", "pd", "pda"}
    torque_share : tuple of float
        For each joint, the mean square of what the form leaves unexplained, as a share of the law's torque.
    needed : tuple of str
        Gains beyond the next narrower form that the data asks for.
    not_needed : tuple of str
        Gains beyond the next narrower form that the data shows to be nearly zero.
    undetermined : tuple of str
        Gains beyond the next narrower form that the data cannot distinguish from parameters of the arm.
    """

    law: Law
    torque_share: tuple[float, ...]
    needed: tuple[str, ...]
    not_needed: tuple[str, ...]
    undetermined: tuple[str, ...]


@dataclass(frozen=True)
class LawMisfit:
    """How well the form of the law that was assumed fits.

    Attributes
    ----------
    torque_share : tuple of float
        As in `LawForm`, of the form that was assumed.
    fits : bool
        Whether no wider form is asked for.
    missing : tuple of str
        Terms that are missing, such as ``ka ddq``.
    sentence : str
    """

    torque_share: tuple[float, ...]
    fits: bool
    missing: tuple[str, ...]
    sentence: str


def law_form(fit: LawFit, gram: Floats) -> LawForm:
    """Return what a fit says of the form of its law.

    Parameters
    ----------
    fit : LawFit
    gram : (n_joint, n_column, n_column)
        Sums of products of the columns of the motion's equations.
    """
    narrower = _narrower(fit.columns.law)
    extra = [] if narrower is None else [n for n in fit.columns.gain_names if _kind(n) not in GAINS[narrower]]
    free = {int(k) for k in fit.free}
    identified = [name for name in extra if fit.identifiable(name)]
    others, open_ones = (name for name in extra if name not in identified), _open(fit, free)
    undetermined = [name for name in others if fit.columns.names.index(name) in open_ones]
    needed = [name for name in identified if _is_there(fit, name, gram)]
    return LawForm(
        fit.columns.law,
        tuple(fit.torque_share.tolist()),
        tuple(needed),
        tuple(name for name in identified if name not in needed),
        tuple(undetermined),
    )


def misfit(assumed: Law, forms: Mapping[Law, LawForm], fits: Mapping[Law, LawFit]) -> LawMisfit:
    """Return how well the assumed form fits, compared with the others.

    Parameters
    ----------
    assumed : {"p", "pd", "pda"}
    forms, fits : mapping from law
        Of the assumed form and of all others that could be fitted.
    """
    form = forms[assumed]
    wider = [forms[law] for law in GAINS if law in forms and len(GAINS[law]) > len(GAINS[assumed])]
    asked = next((other for other in reversed(wider) if other.needed), None)
    own = f"{EQUATIONS[assumed]}, {_form(assumed)}"
    if asked is not None:
        missing = tuple(dict.fromkeys(_kind(name) for other in wider for name in other.needed))
        gains = ", ".join(_estimate(fits[asked.law], name) for name in asked.needed)
        unexplained = ", ".join(f"{100 * share:.3g} %" for share in form.torque_share)
        sentence = (
            f"the law is not of the form {own}: it leaves {unexplained} of the joints' torque unexplained (mean "
            f"square), and the missing term looks like {' and '.join(TERMS[gain] for gain in missing)} ({gains})"
        )
        return LawMisfit(form.torque_share, False, tuple(TERMS[gain] for gain in missing), sentence)
    sentence = f"the motion is of the form {own}; no term of a wider form is asked for"
    if form.not_needed and not form.needed and not form.undetermined:
        narrower = _narrower(assumed)
        assert narrower is not None
        sentence += f", and the narrower form {EQUATIONS[narrower]}, {_form(narrower)}, does as well"
    silent = [name for other in (form, *wider) for name in other.undetermined]
    if silent:
        sentence += f"; whether it has {', '.join(silent)} can't be identified: the arm itself may do the same"
    return LawMisfit(form.torque_share, True, (), sentence)


def _is_there(fit: LawFit, name: str, gram: Floats) -> bool:
    k = fit.columns.names.index(name)
    place = int(np.flatnonzero(fit.free == k)[0])
    variance = float(fit.covariance[place, place])
    value, joint = float(fit.values[k]), (k - fit.columns.n_base) % fit.columns.n_joint
    law = np.where(np.arange(len(fit.values)) < fit.columns.n_base, 0.0, fit.values)
    n = len(law)
    torque = float(law @ gram[joint, :n, :n] @ law)
    large = value**2 * float(gram[joint, k, k]) > _LEAST_TORQUE**2 * torque
    return bool(large and variance > 0.0 and value**2 / variance > scipy.stats.chi2.isf(_SIGNIFICANCE, 1))


def _open(fit: LawFit, free: set[int]) -> set[int]:
    return {int(k) for k in np.flatnonzero(fit.ambiguity.open())} & (free | set(fit.ambiguity.folded))


def _narrower(law: Law) -> Law | None:
    forms = list(GAINS)
    place = forms.index(law)
    return forms[place - 1] if place else None


def _kind(name: str) -> str:
    return name.rstrip("0123456789")


def _form(law: Law) -> str:
    return " + ".join(TERMS[gain] for gain in GAINS[law])


def _estimate(fit: LawFit, name: str) -> str:
    return f"{name} = {describe(fit.columns, fit.values, fit.std(), name)}"


def describe(columns: LawColumns, values: Floats, std: Floats, name: str) -> str:
    """Return a value with half of its 95 % interval and its unit, in words."""
    k = columns.names.index(name)
    return f"{with_interval(float(values[k]), float(std[k]))} {columns.units[k]}"
