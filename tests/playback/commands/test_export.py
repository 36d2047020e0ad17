"""What `limbplay export` asks its writers for, with writers that only note it."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from playback.__main__ import main
from playback.commands import export

Noted = dict[str, Any]


@pytest.fixture
def noted(monkeypatch: pytest.MonkeyPatch) -> Noted:
    """Return what the last writer was given."""
    found: Noted = {}

    def pictures(motion: Any, width: int, height: int) -> range:
        found.update(size=(width, height))
        return range(len(motion.t))

    def writer(name: str) -> Any:
        def write(path: Path, *given: Any) -> None:
            found.update(writer=name, given=given, items=[])
            for one in given:
                if hasattr(one, "__next__"):
                    found["items"] = list(one)
            path.write_bytes(b"12345")

        return write

    names = ("write_gltf", "write_table", "write_mp4", "write_gif", "write_foxglove")
    module = SimpleNamespace(pictures=pictures, **{name: writer(name) for name in names})
    monkeypatch.setattr(export, "import_module", lambda _name: module)
    return found


def exported(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    assert main(["export", *map(str, arguments), "--arm", "dd-arm", "--json"]) == 0
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


@pytest.mark.parametrize(
    ("suffix", "writer", "rate_hz", "size"),
    [
        (".glb", "write_gltf", 60.0, None),
        (".gltf", "write_gltf", 60.0, None),
        (".csv", "write_table", 60.0, None),
        (".mcap", "write_foxglove", 60.0, None),
        (".mp4", "write_mp4", 60.0, [1280, 720]),
        (".GIF", "write_gif", 25.0, [800, 450]),
    ],
)
def test_a_suffix_has_its_writer_rate_and_size(
    suffix: str,
    writer: str,
    rate_hz: float,
    size: list[int] | None,
    motion_file: Path,
    tmp_path: Path,
    noted: Noted,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / f"motion{suffix}"
    answer = exported(capsys, motion_file, "--out", out)
    frames = {60.0: 31, 25.0: 13}[rate_hz]  # half a second
    assert answer == {
        **{"file": str(out), "format": suffix[1:].lower(), "source": "waves.npz", "arm": "dd-arm", "twin": None},
        **{"trial": 1, "frames": frames, "rate_hz": rate_hz, "speed": 1.0, "size": size, "bytes": 5, "notes": []},
        "duration_s": pytest.approx((frames - 1) / rate_hz),
    }
    assert noted["writer"] == writer
    assert noted["items"] == ([] if suffix in (".glb", ".gltf", ".csv") else list(range(frames)))
    if size is not None:
        assert noted["size"] == tuple(size)
    if writer == "write_mp4":
        assert noted["given"][1:] == ((1280, 720), 60.0)
    if writer == "write_gif":
        assert noted["given"][1] == 25.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a.csv", "--rate-hz", "1000"], None),
        (["a.csv", "--rate-hz", "1000.1"], "--rate-hz is 1000.1, expected above 0 and at most 1000 for .csv"),
        (["a.csv", "--rate-hz", "nan"], "--rate-hz is nan"),
        (["a.gif", "--rate-hz", "50.5"], "expected above 0 and at most 50 for .gif"),
        (["a.gif", "--rate-hz", "0.0015"], "--rate-hz is 0.0015, expected at least 0.001526 for .gif"),
        (["a.gif", "--rate-hz", "0.0016"], None),
        (["a.gif", "--rate-hz", "0"], "--rate-hz is 0, expected above 0 and at most 50 for .gif"),
        (["a.csv", "--speed", "0.001"], None),
        (["a.csv", "--speed", "0.0009"], "--speed is 0.0009, expected from 0.001 to 1000"),
        (["a.csv", "--speed", "1001"], "--speed is 1001, expected from 0.001 to 1000"),
        (["a.csv", "--speed", "nan"], "--speed is nan, expected from 0.001 to 1000"),
        (["a.mp4", "--size", "320x180"], None),
        (["a.gif", "--size", "318x180"], "expected WxH in even pixels from 320x180 to 3840x2160"),
        (["a.mp4", "--size", "3840x2162"], "--size is '3840x2162'"),
        (["a.mp4", "--size", "640x361"], "--size is '640x361'"),
        (["a.mp4", "--size", "640x360x3"], "--size is '640x360x3'"),
        (["a.csv", "--size", "640x360"], "--size is given for .csv, expected only for .mp4 and .gif"),
    ],
)
def test_bounds_belong_to_what_is_allowed(
    arguments: list[str],
    said: str | None,
    motion_file: Path,
    tmp_path: Path,
    noted: Noted,
    capsys: pytest.CaptureFixture[str],
) -> None:
    name, *options = arguments
    out = str(tmp_path / name)
    code = main(["export", str(motion_file), "--arm", "dd-arm", "--out", out, *options])
    stderr = capsys.readouterr().err
    assert (code, Path(out).exists()) == ((0, True) if said is None else (2, False)), stderr
    assert said is None or said in " ".join(stderr.split())
    if said is None and name == "a.mp4":
        assert noted["size"] == tuple(int(side) for side in options[1].split("x"))


@pytest.mark.parametrize("option", [[], ["--twin"], ["--reference"]])
def test_what_is_read_is_not_written_over(
    option: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "run.csv"
    path.write_text("kept", encoding="utf-8")
    assert main(["export", *option, "run.csv", "--arm", "dd-arm", "--out", str(path)]) == 2
    assert "this file is read, and one trial would take its place; expected another" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "kept"


def test_two_mistakes_are_told_at_once(motion_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(motion_file), "--out", "a.csv", "--rate-hz", "0", "--speed", "0"]) == 2
    stderr = capsys.readouterr().err
    assert "--rate-hz is 0" in stderr and "--speed is 0" in stderr


@pytest.mark.parametrize(("suffix", "package"), [("glb", "pygltflib"), ("gltf", "pygltflib"), ("mp4", "imageio")])
def test_only_what_needs_a_package_asks_for_it(
    suffix: str,
    package: str,
    motion_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(name=name)

    monkeypatch.setattr(export, "import_module", missing)
    arguments = ["export", str(motion_file), "--arm", "dd-arm", "--out"]
    assert main([*arguments, str(tmp_path / f"a.{suffix}")]) == 2
    assert f"limbplay export to .{suffix} needs the package {package}" in capsys.readouterr().err
    with pytest.raises(ModuleNotFoundError):  # ours, which is no matter of what is installed
        main([*arguments, str(tmp_path / "a.csv")])
