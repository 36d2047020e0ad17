"""`limbplay compile`."""

import json

import numba
import pytest

from playback.__main__ import main


@pytest.mark.parametrize("kernels", [0, 2])
def test_the_command_says_how_many(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, kernels: int
) -> None:
    def compile_all() -> None:
        for _ in range(kernels):
            assert numba.njit(lambda x: x + 1)(1) == 2

    monkeypatch.setattr("playback.commands.compile.compile_all", compile_all)
    assert main(["compile", "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == {"compiled": kernels}
    assert ("limbplay: compiling kernels" in said.err) == bool(kernels)
