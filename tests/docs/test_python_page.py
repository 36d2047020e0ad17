"""The page of the Python interface says what the docstrings say, and its example runs."""

import re
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_is_what_the_docstrings_say():
    spec = spec_from_file_location("python_page", DOCS / "python_page.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    text = (DOCS / "python.md").read_text(encoding="utf-8")
    assert text == module.page(), "run `python docs/python_page.py`"


def test_its_example_runs(capsys):
    example = re.search(r"```python\n(.*?)```", (DOCS / "python.md").read_text(encoding="utf-8"), re.DOTALL)
    exec(example.group(1), {})
    assert capsys.readouterr().out
