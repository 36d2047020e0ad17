"""Which tests should notice a fault in a module."""

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path


def tests_of(root: Path, path: str, most: int) -> list[str]:
    """Return the test files nearest to a module, nearest first.

    The nearest is that of its name in the same place under ``tests/``. After it come those of its package that
    import it, those that name it most often first, and those that call a command by its name; then, likewise,
    those of the modules that import it. Where its package has none, those of others do.

    Parameters
    ----------
    root : Path
        Where the checkout is.
    path : str
        The module's file, from there.
    most : int
        How many files.
    """
    found: dict[str, None] = {}
    seen, waiting = {path}, [path]
    while waiting and len(found) < most:
        module = waiting.pop(0)
        own = mirrored(root, module)
        found |= dict.fromkeys(([own] if own else []) + _importers(root, module, _tests(root, path)))
        users = [user for user in _importers(root, module, _modules(root, path)) if user not in seen]
        seen.update(users)
        waiting += users
    return list(found or dict.fromkeys(_importers(root, path, _tests(root, ""))))[:most]


def mirrored(root: Path, path: str) -> str | None:
    """Return the test file of a module's name, if there is one; that of a command may have its name alone."""
    module = Path(path)
    name = {"__init__": module.parent.name, "__main__": "main"}.get(module.stem, module.stem)
    places = [Path("tests") / module.parent / f"test_{name}.py"]
    if module.parent.name == "commands":
        room = Path("tests") / module.parent.parent
        places += [room / f"test_{name}.py", room / name / f"test_{name}_command.py"]
    return next((str(file) for file in places if (root / file).is_file()), None)


def _tests(root: Path, path: str) -> list[str]:
    folder = root.joinpath("tests", *Path(path).parts[:1])
    return sorted(str(file.relative_to(root)) for file in folder.rglob("test_*.py"))


def _modules(root: Path, path: str) -> list[str]:
    folder = root / Path(path).parts[0]
    return sorted(str(file.relative_to(root)) for file in folder.rglob("*.py"))


def _importers(root: Path, path: str, files: list[str]) -> list[str]:
    """Return those of some files that import a module; first those that name most often what they import."""
    name = ".".join(Path(path).with_suffix("").parts).removesuffix(".__init__")
    names = [name, repr(Path(path).stem)] if ".commands." in name else [name]
    uses = {file: sum(_uses(root / file)[one] for one in names) for file in files if file != path}
    return sorted((file for file, count in uses.items() if count), key=lambda file: -uses[file])


@cache
def _uses(file: Path) -> Counter[str]:
    """Return how often a file names what it imports, module by module; and, in quotes, its strings."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    names = Counter(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
    words = (
        node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    imported = Counter({module: 1 + count for module, count in _imports(tree, names)})
    strings = Counter(words)
    named = Counter({word.split(":")[0]: count for word, count in strings.items()})  # "package.module:function"
    return imported + named + Counter({repr(word): count for word, count in strings.items()})


def _imports(tree: ast.AST, names: Counter[str]) -> Iterator[tuple[str, int]]:
    found: Counter[str] = Counter()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for one in node.names:
                found[one.name] += names[one.asname or one.name.split(".")[0]]
        elif isinstance(node, ast.ImportFrom) and node.module:
            for one in node.names:
                found[node.module] += names[one.asname or one.name]
                found[f"{node.module}.{one.name}"] += names[one.asname or one.name]
    yield from found.items()
