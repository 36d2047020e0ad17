"""Three sets of trials that share nothing."""

import argparse

import numpy as np
import pytest
import scipy.io

from arm.model import Arm, Joint
from fitter.commands.diagnosis_sets import add_sets, require_other_samples, sets_of
from fitter.commands.options import add_as_tracked, add_columns
from fitter.data.motion_file import write_motion
from limbcal.errors import ConfigError

ARM = Arm("one", (Joint(a_m=0.3),))
T = 0.01 * np.arange(300)


def parsed(*given):
    parser = argparse.ArgumentParser()
    parser.add_argument("learn", nargs="+")
    add_columns(parser)
    add_as_tracked(parser)
    add_sets(parser)
    return sets_of(parser.parse_args([str(one) for one in given]))


@pytest.fixture
def files(tmp_path):
    for k, name in enumerate(("a", "b", "c")):
        write_motion(tmp_path / f"{name}.csv", {"t": T, "q": np.sin((3.0 + k) * T)[:, None]})
    cells = np.empty((1, 3), dtype=object)
    for k in range(3):
        cells[0, k] = np.sin((1.0 + k) * T)[None]
    scipy.io.savemat(tmp_path / "cells.mat", {"Y": cells})
    return tmp_path


def test_sets_are_read_each_by_its_own_columns(files):
    a, b, cells = files / "a.csv", files / "b.csv", files / "cells.mat"
    sets = parsed(a, "--evaluate", b, "--judge", cells, "--judge-columns", "t=0.01,q=Y(join 2:3)-1")
    learn, evaluate, judge = (one.read(ARM, None) for one in sets)
    assert [motion.name for motion in (*learn, *evaluate, *judge)] == ["a", "b", "cells"]
    assert len(judge[0].t) == 600 and judge[0].t[-1] == pytest.approx(5.99)
    assert [one.read(ARM, None) for one in parsed(a)[1:]] == [[], []]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("a", "--evaluate", "a"), "--evaluate: .*a.csv is learnt from"),
        (("a", "--evaluate", "b", "--judge", "a"), "--judge: .*a.csv is learnt from"),
        (("a", "--evaluate", "b", "--judge", "c", "b"), "--judge: .*b.csv is evaluated on"),
        (("a", "--judge-columns", "t=x"), "--judge-columns is given without --judge"),
    ],
)
def test_a_file_in_two_sets_is_said(files, given, said):
    with pytest.raises(ConfigError, match=said):
        parsed(*(one if one.startswith("-") or "=" in one else files / f"{one}.csv" for one in given))


@pytest.mark.parametrize(("evaluated", "fits"), [("Y(3)", True), ("Y(join 2:3)", False), ("Y(2)", False)])
def test_cells_of_one_file_may_be_in_two_sets_but_none_in_both(files, evaluated, fits):
    path = files / "cells.mat"
    sets = parsed(
        path,
        "--columns",
        "t=0.01,q=Y(join 1:2)",
        "--evaluate",
        path,
        "--evaluate-columns",
        f"t=0.01,q={evaluated}",
    )
    read = [(one, one.read(ARM, None)) for one in sets]
    if fits:
        require_other_samples(read)
    else:
        with pytest.raises(ConfigError, match="--evaluate: cells has samples that are learnt from"):
            require_other_samples(read)
