"""How many digits of a number are printed: those that its uncertainty leaves.

The half-width of the 95 % interval is given with two significant digits and the value to the same decimal place,
as section 7.2.6 of the Guide to the Expression of Uncertainty in Measurement (JCGM 100:2008) has it.
"""

import math

#: Half-width of the 95 % interval of a normal distribution, in standard deviations.
NORMAL_95 = 1.959964

#: Significant digits of an uncertainty (JCGM 100:2008, 7.2.6: "at most two").
_UNCERTAINTY_DIGITS = 2
#: Significant digits of a value whose uncertainty is not known.
_PLAIN_DIGITS = 4
#: Decimal exponents of what is written without an exponent of its own.
_LOWEST, _HIGHEST = -5, 6


def with_half_width(value: float, half_width: float) -> tuple[str, str]:
    """Return a value and the half-width of its interval as they are printed.

    Parameters
    ----------
    value, half_width : float
        In the same unit; a half-width that is 0 or not finite leaves the value with four digits.

    Returns
    -------
    value, half_width : str
        To the same decimal place, such as ``("1.7186", "0.0012")``; the half-width is a dash where there is none.
    """
    if not (math.isfinite(half_width) and half_width > 0.0 and math.isfinite(value)):
        return plain(value), "–"
    last = (
        _exponent(half_width, _UNCERTAINTY_DIGITS) - _UNCERTAINTY_DIGITS + 1
    )  # of the last digit that is printed
    return _to_place(value, last), _to_place(half_width, last)


def with_interval(value: float, std: float) -> str:
    """Return a value with half of its 95 % interval, such as ``1.7186 ± 0.0012``; alone where that is not known.

    Parameters
    ----------
    value, std : float
        The standard error in the same unit.
    """
    said, half_width = with_half_width(value, NORMAL_95 * std)
    return said if half_width == "–" else f"{said} ± {half_width}"


def to_the_place_of(value: float, half_width: float) -> str:
    """Return another value to the decimal place of a half-width; with four digits where there is none."""
    return with_half_width(value, half_width)[0]


def plain(value: float, digits: int = _PLAIN_DIGITS) -> str:
    """Return a value without an uncertainty, with some significant digits; a dash for what is no number."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    exponent = _exponent(value, digits)
    if not _LOWEST <= exponent < _HIGHEST:
        return f"{value:.{digits - 1}e}"
    return f"{round(value, digits - 1 - exponent):.{max(digits - 1 - exponent, 0)}f}"


def _exponent(value: float, digits: int) -> int:
    """Return the decimal exponent of a value after it was rounded to some significant digits."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])


def _to_place(value: float, last: int) -> str:
    """Return a value rounded to the place 10^last."""
    rounded = round(value, -last)
    if rounded == 0.0:
        return f"{0.0:.{-last}f}" if _LOWEST - _UNCERTAINTY_DIGITS < last < 0 else "0"
    exponent = _exponent(rounded, max(1, _exponent(rounded, 17) - last + 1))
    if _LOWEST <= exponent < _HIGHEST:
        return f"{rounded:.{max(-last, 0)}f}"
    return f"{rounded:.{max(exponent - last, 0)}e}"
