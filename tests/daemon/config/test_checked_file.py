"""What a file is shows in what is in it."""

from pathlib import Path

import pytest

from arm.arm_file import format_arm, load_arm
from daemon.config.checked_file import arm_and_source
from limbcal.errors import ConfigError


def test_an_arm_and_a_config_are_told_apart(tmp_path: Path) -> None:
    arm, config = tmp_path / "one.toml", tmp_path / "two.toml"
    arm.write_text(format_arm(load_arm("dd-arm")))
    config.write_text('[device]\nport = "/dev/ttyX"\n[arm]\nfile = "dd-arm"\n')
    assert arm_and_source(arm)[::2] == ("arm", str(arm))
    assert arm_and_source(config)[::2] == ("config", "dd-arm")
    assert arm_and_source(Path("dd-arm"))[::2] == ("arm", "dd-arm")


def test_what_is_neither_is_said(tmp_path: Path) -> None:
    file = tmp_path / "x.toml"
    file.write_text("a = [")
    with pytest.raises(ConfigError, match="not TOML"):
        arm_and_source(file)
    with pytest.raises(ConfigError, match="No such file"):
        arm_and_source(tmp_path / "none.toml")
