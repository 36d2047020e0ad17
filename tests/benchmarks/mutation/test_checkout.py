"""Faults are put into a copy, which is as it was afterwards."""

import py_compile
import subprocess
from pathlib import Path

import pytest

from benchmarks.mutation.checkout import Copy

CODE = '"""Some words at the top."""\n\nx = 1\n'


@pytest.fixture
def source(tmp_path: Path) -> Path:
    folder = tmp_path / "source"
    (folder / "room").mkdir(parents=True)
    (folder / "room" / "one.py").write_text(CODE)
    (folder / ".gitignore").write_text("out/\n")
    subprocess.run(["git", "init", "--quiet", str(folder)], check=True)
    return folder


@pytest.mark.parametrize("code", [CODE.replace("1", "2"), CODE.replace("1", "100"), CODE.replace("x = 1", "x")])
def test_a_file_has_other_code_for_a_while_of_the_same_size_and_time(source: Path, code: str) -> None:
    copy = Copy(source, source / "out" / "copy")
    file = copy.root / "room" / "one.py"
    before, stat = file.read_bytes(), file.stat()
    compiled = Path(py_compile.compile(str(file)) or "")
    with copy.having("room/one.py", code):
        assert file.read_text().split('"""')[2].strip() == code.split('"""')[2].strip()
        assert (file.stat().st_size, file.stat().st_mtime_ns) == (stat.st_size, stat.st_mtime_ns)
        assert not compiled.exists()
    assert file.read_bytes() == before == (source / "room" / "one.py").read_bytes()
    assert file.stat().st_mtime_ns == stat.st_mtime_ns


def test_it_is_as_it_was_also_after_an_error(source: Path) -> None:
    copy = Copy(source, source / "out" / "copy")
    with pytest.raises(KeyError), copy.having("room/one.py", "x = 2\n"):
        raise KeyError
    assert (copy.root / "room" / "one.py").read_text() == CODE


def test_a_copy_is_brought_up_to_date(source: Path) -> None:
    Copy(source, source / "out" / "copy")
    (source / "room" / "one.py").rename(source / "room" / "two.py")
    (source / "room" / "three.py").write_text("x = 3\n")
    copy = Copy(source, source / "out" / "copy")
    assert sorted(file.name for file in (copy.root / "room").iterdir()) == ["three.py", "two.py"]
