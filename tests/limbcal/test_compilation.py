"""Whoever waits for the compiler hears so, once; whoever need not wait hears nothing."""

import numba
import pytest

from limbcal.compilation import said_when_compiling


def kernel():
    """Return a kernel that nobody has compiled."""
    return numba.njit(lambda x: x + 1)


def test_compiling_is_said_once_and_counted(capsys):
    with said_when_compiling("somebody") as compilation:
        assert kernel()(1) == 2
        assert kernel()(1) == 2
    assert compilation.kernels == 2 and compilation.document() == {"compiled": 2}
    assert capsys.readouterr().err.count("somebody: compiling kernels") == 1


def test_nothing_is_said_where_nothing_is_compiled(capsys):
    ready = kernel()
    ready(1)
    with said_when_compiling("somebody") as compilation:
        ready(1)
    kernel()(1)
    assert compilation.kernels == 0
    assert capsys.readouterr().err == ""


def test_a_kernel_within_another_is_part_of_it(capsys):
    inner = kernel()
    outer = numba.njit(lambda x: 2 * inner(x))
    with said_when_compiling("somebody") as compilation:
        assert outer(1) == 4
    assert compilation.kernels == 1


def test_who_is_called_by_another_leaves_the_words_to_it(capsys):
    with said_when_compiling("all") as whole, said_when_compiling("a part") as part:
        kernel()(1)
    assert part is whole and whole.kernels == 1
    said = capsys.readouterr().err
    assert "all: " in said and "a part" not in said


def test_a_failure_ends_the_listening(capsys):
    with pytest.raises(ZeroDivisionError), said_when_compiling("somebody"):
        raise ZeroDivisionError
    kernel()(1)
    assert capsys.readouterr().err == ""
