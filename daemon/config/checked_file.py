"""What a file is that `limbd check` is given: a config, or an arm."""

from pathlib import Path

from arm.arm_file import load_arm, preset_names
from arm.model import Arm
from daemon.config.config import load_setup
from limbcal.errors import ConfigError
from limbcal.toml import parse_toml, read_toml_text

#: Tables and keys that only an arm file has.
_OF_AN_ARM = {"schema", "joint", "sensor", "gravity_m_s2", "tip", "base_parameters", "effect", "control"}


def arm_and_source(file: Path) -> tuple[str, Arm, str]:
    """Return what a file is, ``arm`` or ``config``, the arm that it describes or names, and where that is.

    Raises
    ------
    ConfigError
        With every mistake in it.
    """
    if _is_arm(file):
        return "arm", load_arm(file), str(file)
    setup = load_setup(file, {})
    return "config", setup.arm, setup.config.arm.file


def _is_arm(file: Path) -> bool:
    """Say whether a file is meant to be an arm, by what is in it."""
    if not file.exists():
        return str(file) in preset_names()
    try:
        found = parse_toml(read_toml_text(file), str(file))
    except (OSError, ConfigError):
        return False  # whoever reads it as a config says what is wrong
    return bool(_OF_AN_ARM & found.keys())
