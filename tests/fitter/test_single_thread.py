"""BLAS runs in one thread, unless the environment says otherwise."""

import importlib
import os

import pytest

import fitter.single_thread

NAMES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def test_every_blas_gets_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "7")  # so that it is put back
        monkeypatch.delenv(name)
    importlib.reload(fitter.single_thread)
    assert [os.environ[name] for name in NAMES] == ["1"] * 3


@pytest.mark.parametrize("name", NAMES)
def test_what_the_environment_says_stands(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(name, "3")
    importlib.reload(fitter.single_thread)
    assert os.environ[name] == "3"
