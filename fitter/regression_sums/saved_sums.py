"""Torque sums in a file: what a fit needs of a million samples, to be added to others' and fitted anywhere."""

import os
import struct
import zipfile
import zlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arm.chain import chain_of
from arm.control import gains
from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.regression_sums.torque_sums import TorqueSums, add_up
from limbcal.errors import ConfigError, DataError, DeviceError
from protocol.tables.expansion import require_modest

SCHEMA = 1
#: What the reader of a damaged file is seen to raise.
_DAMAGE = (
    OSError,
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    RuntimeError,
    MemoryError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)


@dataclass(frozen=True)
class Equation:
    """What the rows of eq. (9) are made of besides the data: only sums of the same equation can be added.

    Attributes
    ----------
    joint_types : tuple of str
    geometry : tuple of (alpha, a, d, beta, theta offset), one a joint [rad, m]
    gravity_m_s2 : tuple of float
    law : str
        Of the control that the torque is taken from, or "measured".
    gains : tuple of float
        kp, kv and ka of all joints; empty where the torque is measured.
    base_names : tuple of str
    columns : tuple of int
        The regressor's columns that the base parameters go with.
    rest_speed : float [rad/s or m/s]
    """

    joint_types: tuple[str, ...]
    geometry: tuple[float, ...]
    gravity_m_s2: tuple[float, ...]
    law: str
    gains: tuple[float, ...]
    base_names: tuple[str, ...]
    columns: tuple[int, ...]
    rest_speed: float

    def difference(self, other: "Equation") -> str | None:
        """Say in what another equation differs, naming both values; None if it does not."""
        for field in fields(self):
            mine, theirs = getattr(self, field.name), getattr(other, field.name)
            if mine != theirs:
                return f"{field.name} is {_listed(mine)}, expected {_listed(theirs)}"
        return None


@dataclass(frozen=True)
class ArmSums:
    """Sums of some trials of one arm.

    Attributes
    ----------
    equation : Equation
    sums : TorqueSums
    trials : tuple of str
        Names of the trials, as `TorqueSums.trial` counts them.
    """

    equation: Equation
    sums: TorqueSums
    trials: tuple[str, ...]

    def require(self, equation: Equation, where: str) -> None:
        """Make sure that these sums are of some equation.

        Raises
        ------
        ConfigError
            If they are not, naming what differs.
        """
        if difference := self.equation.difference(equation):
            raise ConfigError(f"{where}: these sums are of another arm or law: {difference}")


def equation_of(arm: Arm, rest_speed: float) -> Equation:
    """Return the equation that an arm's trials are reduced with."""
    chain, base = chain_of(arm), structural_parameters(arm)
    measured = arm.control.law == "measured"
    return Equation(
        tuple(joint.type for joint in arm.joints),
        tuple(chain.geometry.ravel().tolist()),
        tuple(chain.gravity.tolist()),
        arm.control.law,
        () if measured else tuple(np.ravel(gains(arm.control, arm.n_joint)).tolist()),
        base.names,
        base.independent,
        rest_speed,
    )


def add_sums(parts: Sequence[ArmSums], names: Sequence[str]) -> ArmSums:
    """Add sums up, trials in the order of the parts; ``(a + b) + c`` and ``a + (b + c)`` are the same bits.

    A trial that counted twice would make the answer look surer than it is.

    Parameters
    ----------
    parts : sequence of ArmSums
    names : sequence of str
        What to call each in an error.

    Raises
    ------
    ConfigError
        If they are not all of the same arm and law, or a trial is in two of them.
    """
    seen: dict[bytes, str] = {}
    for part, name in zip(parts, names, strict=True):
        part.require(parts[0].equation, name)
        seals = _seals(part)
        for seal, trial in seals.items():
            if seal in seen:
                what = f"trial {trial!r} is in {seen[seal]} too, to the last bit"
                raise ConfigError(f"{name}: {what}; expected sums of different trials")
        seen |= dict.fromkeys(seals, name)
    trials = tuple(trial for part in parts for trial in part.trials)
    return ArmSums(parts[0].equation, add_up([part.sums for part in parts]), trials)


def _seals(part: ArmSums) -> dict[bytes, str]:
    """Return bytes that tell trials apart, and their names; not of those without a sample that counts."""
    sums, seals = part.sums, {}
    for k, trial in enumerate(part.trials):
        of_trial = sums.trial == k
        if sums.count[of_trial].any():
            seals[sums.moment[of_trial].tobytes() + sums.power[of_trial].tobytes()] = trial
    return seals


def is_sums(path: Path) -> bool:
    """Say whether a file holds sums, and not motion."""
    if path.suffix.lower() != ".npz" or not path.is_file():
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return {"sums_schema.npy", "gram.npy"} <= set(archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


def save_sums(path: Path, saved: ArmSums) -> None:
    """Write sums as NPZ, in one step once all is written; the same sums give the same bytes.

    Raises
    ------
    ConfigError
        If the suffix is another.
    DeviceError
        If the disk fails.
    """
    if path.suffix.lower() != ".npz":
        raise ConfigError(f"{path}: the suffix is {path.suffix!r}, expected .npz")
    arrays = {field.name: np.asarray(getattr(saved.equation, field.name)) for field in fields(Equation)}
    arrays |= {name: np.asarray(getattr(saved.sums, name)) for name in (*_shapes(0, 0, 0), "samples")}
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            np.savez_compressed(
                file,
                allow_pickle=False,
                sums_schema=np.asarray(SCHEMA),
                trials=np.array(saved.trials, dtype=np.str_),
                **arrays,
            )
        os.replace(part, path)
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def load_sums(path: Path) -> ArmSums:
    """Read sums; nothing in the file is unpickled.

    Raises
    ------
    DataError
        If the file is missing or damaged, of another schema, or its arrays don't fit each other.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such file")
    try:
        equation_fields = (field.name for field in fields(Equation))
        names = ("sums_schema", "samples", "trials", *equation_fields, *_shapes(0, 0, 0))
        with zipfile.ZipFile(path) as archive:
            sizes = {member.filename: member.file_size for member in archive.infolist()}
        require_modest(path, sum(sizes.get(f"{name}.npy", 0) for name in names), "its sums")
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays = {name: file[name] for name in names}
        schema = arrays.pop("sums_schema").item()
        if schema != SCHEMA:
            raise DataError(f"{path}: sums of schema {schema}, expected {SCHEMA}")
        equation = Equation(**{field.name: _plain(arrays[field.name]) for field in fields(Equation)})
        samples = int(arrays.pop("samples"))
        sums = TorqueSums(**{name: arrays[name] for name in _shapes(0, 0, 0)}, samples=samples)
        saved = ArmSums(equation, sums, _plain(arrays["trials"]))
    except _DAMAGE as error:
        raise DataError(f"{path}: cannot be read as sums ({error})") from error
    if mistake := _mistake(saved):
        raise DataError(f"{path}: {mistake}")
    return saved


def _plain(array: NDArray[np.generic]) -> Any:
    """Return an array as what it was made of: a number, a text or a tuple of such."""
    return tuple(array.tolist()) if array.ndim else array.item()


def _listed(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _shapes(blocks: int, n: int, k: int) -> dict[str, tuple[int, ...]]:
    matrices = {"gram": (blocks, n, k, k), "moment": (blocks, n, k), "row": (blocks, n, k)}
    return matrices | {"power": (blocks, n), "torque": (blocks, n), "count": (blocks, n), "trial": (blocks,)}


def _mistake(saved: ArmSums) -> str | None:
    """Say which array does not fit the others, or holds what no sums hold."""
    blocks, n, k = len(saved.sums.trial), len(saved.equation.joint_types), len(saved.equation.base_names)
    for name, shape in _shapes(blocks, n, k).items():
        array = getattr(saved.sums, name)
        if array.shape != shape:
            return f"{name} has shape {array.shape}, expected {shape}"
        if not np.isfinite(array).all():
            return f"{name} holds values that are not finite"
    steps = np.diff(saved.sums.trial, prepend=0)
    if blocks and not (np.isin(steps, (0, 1)).all() and saved.sums.trial[-1] + 1 == len(saved.trials)):
        return f"its blocks are not of trials 1 to {len(saved.trials)} one after the other"
    return None
