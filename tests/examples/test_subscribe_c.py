"""The subscriber in C, built as its first lines say, against a real publisher and a real playback."""

import shutil
import subprocess
from pathlib import Path

import pytest

from protocol.message import FRAMES, PLAY
from tests.examples.stream import EXAMPLES, check_printed, run_against_a_stream


def pkg_config(*packages: str) -> list[str] | None:
    if shutil.which("pkg-config") is None:
        return None
    for_all = ["pkg-config", "--cflags", "--libs", *packages]
    found = subprocess.run(for_all, capture_output=True, text=True, check=False)
    return found.stdout.split() if found.returncode == 0 else None


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    options = pkg_config("libzmq", "msgpack") or pkg_config("libzmq", "msgpack-c")
    if options is None:
        pytest.skip("the headers are not there: Debian has them in libzmq3-dev, libmsgpack-dev and pkg-config")
    built = tmp_path_factory.mktemp("c") / "subscribe"
    strict = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-O1"]
    command = [compiler, *strict, "-o", str(built), str(EXAMPLES / "subscribe.c"), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return built


@pytest.mark.parametrize("topic", [FRAMES, PLAY])
def test_it_prints_time_joints_and_tip(program: Path, topic: str) -> None:
    lines = run_against_a_stream([str(program)], topic)
    assert len(lines) == 3
    for line in lines:
        check_printed(line)


def test_a_wrong_endpoint_is_said(program: Path) -> None:
    done = subprocess.run([str(program), "nonsense"], capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert done.stderr.strip() == "Invalid argument"
