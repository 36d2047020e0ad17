"""What may be wrong with the covariance of sensors in an arm file."""

from collections.abc import Sequence

import numpy as np

#: The numbers of a sensor that a calibration finds, each along or about three axes.
KINDS = ("bias", "scale", "turn", "place", "gyro_bias", "gyro_scale")
_NUMBERS = tuple(f"{kind}_{axis}" for kind in KINDS for axis in "xyz")
#: A covariance that was written and read may be negative by so much, in units of its variances.
_ROUNDING = 1e-9


def mistakes_of_covariance(table: object, sensors: Sequence[str]) -> list[str]:
    """Return one sentence a mistake in a ``[sensor_covariance]``; what is none of a table is the schema's to say.

    Parameters
    ----------
    table : object
        As it stands in the file.
    sensors : sequence of str
        Names of the arm's sensors.
    """
    if not isinstance(table, dict):
        return []
    names, rows = table.get("parameters"), table.get("covariance")
    if not isinstance(names, list) or not isinstance(rows, list):
        return []
    sentences = []
    for name in names:
        sensor, _, number = str(name).rpartition(" ")
        if sensor not in sensors or number not in _NUMBERS:
            expected = f"a sensor ({', '.join(sensors) or 'none'}) and one of {', '.join(_NUMBERS)}"
            sentences.append(f"sensor_covariance.parameters has {name!r}, expected {expected}")
    triangle = len(rows) == len(names) and all(isinstance(row, list) for row in rows)
    if not triangle or any(len(row) != k + 1 for k, row in enumerate(rows)):
        expected = f"a lower triangle of {len(names)} rows, of 1 to {len(names)} numbers"
        return [*sentences, f"sensor_covariance.covariance has {len(rows)} rows, expected {expected}"]
    try:
        lower = np.zeros((len(rows), len(rows)))
        for k, row in enumerate(rows):
            lower[k, : k + 1] = row
    except (TypeError, ValueError):
        return sentences
    scale = np.sqrt(np.maximum(np.diag(lower), 1e-300))
    matrix = (lower + np.tril(lower, -1).T) / np.outer(scale, scale)
    if len(rows) and np.isfinite(matrix).all() and np.linalg.eigvalsh(matrix).min() < -_ROUNDING:
        sentences.append("sensor_covariance.covariance is negative in some direction, expected a covariance")
    return sentences
