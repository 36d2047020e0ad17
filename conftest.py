"""How the tests are shared out between processes (`make test` runs two)."""

from pathlib import Path

import pytest

#: Tests that look at what a machine has but one of: processes, ports, shared memory.
ALONE = ("daemon", "playback", "examples", "protocol")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep tests of a file together, for they share fixtures, and all that look at the machine in one process."""
    for item in items:
        inside = Path(item.path).relative_to(item.config.rootpath / "tests").parts
        item.add_marker(pytest.mark.xdist_group("machine" if inside[0] in ALONE else "/".join(inside)))
