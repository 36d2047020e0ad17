"""The service's files: laid down, taken away, clean by systemd's own tools."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from daemon.__main__ import main
from daemon.config import load_setup

analyze = pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
UNITS = ("limbd.service", "limbplay.service")
WORST = 1.6


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def test_what_is_laid_down_is_taken_away(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["install", "--prefix", str(tmp_path), "--json"]
    assert main([*arguments, "--dry-run"]) == 0
    assert files(tmp_path) == set()
    capsys.readouterr()
    assert main(arguments) == 0
    done = json.loads(capsys.readouterr().out)["done"]
    assert {what for what, _ in done} == {"written"}
    assert files(tmp_path) == {str(Path(path).relative_to(tmp_path)) for _, path in done}
    config = tmp_path / "etc/limbcal/limbd.toml"
    assert load_setup(config, {}).arm.name == "dd-arm"
    config.write_text(config.read_text() + "# mine\n")
    assert main(arguments) == 0
    assert config.read_text().endswith("# mine\n")
    assert main([*arguments, "--remove"]) == 0
    assert files(tmp_path) == {"etc/limbcal/limbd.toml", "etc/limbcal/limbplay.env"}


def test_where_nothing_may_be_written_it_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "etc").write_text("in the way")
    assert main(["install", "--prefix", str(tmp_path)]) == 3
    assert "error: " in capsys.readouterr().err


@analyze
@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_is_clean_and_shut(unit: str, tmp_path: Path) -> None:
    main(["install", "--prefix", str(tmp_path)])
    path = str(tmp_path / "etc/systemd/system" / unit)
    verified = subprocess.run(["systemd-analyze", "verify", path], check=False, capture_output=True, text=True)
    assert (verified.returncode, [line for line in verified.stderr.splitlines() if unit in line]) == (0, [])
    judged = subprocess.run(
        ["systemd-analyze", "security", "--offline=true", "--no-pager", path],
        check=False,
        capture_output=True,
        text=True,
    )
    level = float(judged.stdout.split("Overall exposure level")[1].split(":")[1].split()[0])
    assert level <= WORST
