"""A copy of the checkout, into which faults are put; nobody's own files are touched."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class Copy:
    """What git knows of, and new files that it does not ignore, as they are now; with the compiled kernels.

    Parameters
    ----------
    source, target : Path
        What is copied, and where to. What the target has of an earlier run is brought up to date.
    """

    def __init__(self, source: Path, target: Path) -> None:
        self.root = target
        listed = ["git", "-C", str(source), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        out = subprocess.run(listed, capture_output=True, text=True, check=True).stdout  # noqa: S603, S607 - plain git
        names = {name for name in out.split("\0") if name and (source / name).is_file()}
        for file in [file for file in target.rglob("*") if file.is_file() and "__pycache__" not in file.parts]:
            if str(file.relative_to(target)) not in names:
                file.unlink()
        kernels = {str(file.relative_to(source)) for file in source.glob("[!.]*/**/__pycache__/*.nb[ic]")}
        for name in sorted(names | {name for name in kernels if not name.startswith("out/")}):
            _bring(source / name, target / name)

    @contextmanager
    def having(self, name: str, code: str) -> Iterator[None]:
        """Give a file other code for a while.

        Its time and size stay, by which the compiler knows its kernels (it looks at those themselves, too): they
        need not be compiled anew for a fault beside them. What Python has compiled of it goes: it would pass.
        """
        file = self.root / name
        before, stat = file.read_bytes(), file.stat()
        try:
            self._write(file, _of_size(code.encode(), len(before)), stat)
            yield
        finally:
            self._write(file, before, stat)

    @staticmethod
    def _write(file: Path, code: bytes, stat: os.stat_result) -> None:
        file.write_bytes(code)
        os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        for stale in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
            stale.unlink()


def _of_size(code: bytes, size: int) -> bytes:
    """Make code as long as it was, by the words at the top of the module or blanks at its end."""
    more = len(code) - size
    if more <= 0:
        return code.rstrip(b"\n") + b" " * -more + b"\n"
    start = code.find(b'"""') + len(b'"""')
    end = code.find(b'"""', start)
    return code[:start] + b"." * (end - start - more) + code[end:] if end - start > more else code


def _bring(source: Path, target: Path) -> None:
    """Copy a file, unless it is there already."""
    now = source.stat()
    if target.exists():
        then = target.stat()
        if "__pycache__" in target.parts or (now.st_size, now.st_mtime_ns) == (then.st_size, then.st_mtime_ns):
            return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, target)
