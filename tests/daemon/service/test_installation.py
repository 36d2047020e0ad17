"""The service's files: laid down, taken away, clean by systemd's own tools."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from daemon.__main__ import main
from daemon.config.config import load_setup
from daemon.service.installation import install

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


def test_what_is_no_text_is_written_over(tmp_path: Path) -> None:
    install(tmp_path)
    rules = tmp_path / "etc/udev/rules.d/99-limbcal.rules"
    text = rules.read_bytes()
    rules.write_bytes(b"\xff\xfe")
    assert ["written", str(rules)] in install(tmp_path)["done"]
    assert rules.read_bytes() == text


@analyze
@pytest.mark.parametrize("folder", ["two words", "100%u"])
def test_any_folder_may_hold_the_programs(folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    programs = tmp_path / folder
    programs.mkdir()
    for name in ("limbd", "limbplay"):
        (programs / name).symlink_to("/bin/true")
    monkeypatch.setattr(sys, "executable", str(programs / "python"))
    install(tmp_path)
    for unit in UNITS:
        path = str(tmp_path / "etc/systemd/system" / unit)
        verified = subprocess.run(["systemd-analyze", "verify", path], check=False, capture_output=True, text=True)
        assert [line for line in verified.stderr.splitlines() if unit in line] == []


@analyze
def test_an_environment_in_a_home_is_seen_by_the_service(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """ProtectHome=yes hides /home, and the program in it with it."""
    monkeypatch.setattr(sys, "prefix", "/home/two words/100%u")
    install(tmp_path)
    for unit in UNITS:
        path = tmp_path / "etc/systemd/system" / unit
        lines = path.read_text().splitlines()
        assert 'BindReadOnlyPaths="/home/two words/100%%u"' in lines
        assert "ProtectHome=tmpfs" in lines and "ProtectHome=yes" not in lines
        verified = subprocess.run(
            ["systemd-analyze", "verify", str(path)], check=False, capture_output=True, text=True
        )
        assert [line for line in verified.stderr.splitlines() if unit in line] == []


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


def test_what_is_done_to_each_file_is_told(tmp_path: Path) -> None:
    def done(**how: bool) -> dict[str, str]:
        found = install(tmp_path, **how)
        assert found["prefix"] == str(tmp_path) and found["dry_run"] == how.get("dry_run", False)
        pairs: list[list[str]] = found["done"]  # type: ignore[assignment]
        return {Path(path).name: what for what, path in pairs}

    ours = ("limbd.service", "limbplay.service", "limbcal.conf", "99-limbcal.rules")
    theirs = ("limbd.toml", "limbplay.env")

    def of(what: str, to_theirs: str) -> dict[str, str]:
        return {**dict.fromkeys(ours, what), **dict.fromkeys(theirs, to_theirs)}

    assert done(remove=True) == of("not there", "not there")
    assert done(dry_run=True) == of("written", "written")
    assert done() == of("written", "written")
    assert done() == of("there already", "kept")
    unit = tmp_path / "etc/systemd/system/limbd.service"
    text = unit.read_text()
    unit.write_text(text + "# changed\n")
    assert done(dry_run=True) == of("there already", "kept") | {"limbd.service": "written"}
    assert unit.read_text() == text + "# changed\n"
    assert done() == of("there already", "kept") | {"limbd.service": "written"}
    assert unit.read_text() == text
    assert done(remove=True, dry_run=True) == of("removed", "kept") and unit.exists()
    assert done(remove=True) == of("removed", "kept") and not unit.exists()


@pytest.mark.parametrize(
    ("how", "said", "next_steps"),
    [
        ({}, "written: ", True),
        ({"dry_run": True}, "would be written: ", False),
        ({"remove": True}, "not there: ", False),
    ],
)
def test_after_an_installation_the_next_steps_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], how: dict[str, bool], said: str, next_steps: bool
) -> None:
    install(tmp_path, **how)
    captured = capsys.readouterr()
    text = captured.out + captured.err
    assert text.count(said) >= 6 and ("next:" in text) == next_steps
    assert next_steps == ("would be" not in text and "not there" not in text)


def test_units_call_the_programs_of_this_environment(tmp_path: Path) -> None:
    install(tmp_path)
    text = (tmp_path / "etc/systemd/system/limbd.service").read_text()
    assert f"{Path(sys.executable).parent}/limbd" in text and "/opt/limbcal/.venv/bin" not in text
