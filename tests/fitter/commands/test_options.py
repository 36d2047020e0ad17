"""Options that several commands share."""

import argparse

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.commands.options import (
    SMALLEST_POPULATION,
    at_least,
    bounds_of,
    fixed_of,
    joint_values,
    make_room,
    pairs,
    positive,
)
from fitter.search.genetic import GeneticAlgorithm
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "much", ""])
def test_positive_numbers(text):
    assert positive("0.25") == 0.25 and positive("1e3") == 1000.0
    with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a number above 0"):
        positive(text)


@pytest.mark.parametrize("text", ["2", "-3", "3.5", "three", ""])
def test_whole_numbers(text):
    assert at_least(3)("3") == 3 and at_least(0)("0") == 0
    with pytest.raises(argparse.ArgumentTypeError, match="is not a whole number of at least 3"):
        at_least(3)(text)


def test_the_smallest_population_is_the_algorithms():
    rng = np.random.default_rng(0)
    GeneticAlgorithm(np.zeros(2), np.ones(2), rng, SMALLEST_POPULATION)
    with pytest.raises(ValueError, match="population"):
        GeneticAlgorithm(np.zeros(2), np.ones(2), rng, SMALLEST_POPULATION - 1)


def test_a_file_that_is_read_is_not_written_over(tmp_path):
    folder = tmp_path / "of one day"
    folder.mkdir()
    read = [folder, tmp_path / "run.csv"]
    for name in ("run.csv", "motion.csv", "of one day/run.csv", "of one day/arm.toml"):
        (tmp_path / name).touch()
    for name in ("run.csv", "of one day/run.csv", "of one day/../run.csv"):
        with pytest.raises(ConfigError, match="this file is read, and the result would take its place"):
            make_room(tmp_path / name, read=read)
    for name in ("motion.csv", "of one day/arm.toml", "of one day/another.csv"):
        make_room(tmp_path / name, read=read)
    make_room(tmp_path / "run.csv")


def test_one_number_a_joint():
    assert joint_values("0.5,-1", ARM, "--initial-q").tolist() == [0.5, -1.0]
    for text in ("0.5,x", "0.5,", "nan,0", "inf,1"):
        with pytest.raises(ConfigError, match=f"--initial-q is '{text}', expected numbers parted by commas"):
            joint_values(text, ARM, "--initial-q")
    with pytest.raises(ConfigError, match=r"--initial-q has 3 numbers, expected one a joint \(2\)"):
        joint_values("1,2,3", ARM, "--initial-q")


def test_pairs():
    assert pairs(None, "--fix") == {}
    assert pairs("a1=0.2, b", "--fix") == {"a1": "0.2", "b": ""}
    for text in ("a1=1,a1=2", "=3", ""):
        with pytest.raises(ConfigError, match="expected each parameter's name once"):
            pairs(text, "--fix")


def test_bounds_and_known_values():
    assert bounds_of("I1+m2*L1^2=1:3,D1=-1:1") == {"I1+m2*L1^2": (1.0, 3.0), "D1": (-1.0, 1.0)}
    assert fixed_of("D1=0,D2=-0.5") == {"D1": 0.0, "D2": -0.5}
    for text in ("a1=0.1", "a1=0.1:", "a1=:", "a1=0:inf"):
        with pytest.raises(ConfigError, match="--bounds a1: '.*' is not a number"):
            bounds_of(text)
    for text in ("a1", "a1=nan"):
        with pytest.raises(ConfigError, match="--fix a1: '.*' is not a number"):
            fixed_of(text)
