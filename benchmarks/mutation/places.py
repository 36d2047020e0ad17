"""Where a fault may be put: code that Python runs, and that decides something."""

from collections.abc import Iterator

from parso.python.tree import Function, Name
from parso.tree import NodeOrLeaf

#: Decorators that hand a function to the compiler of machine code: its tests would compile it anew.
_COMPILERS = {"compiled", "inlined", "njit", "jit", "overload", "intrinsic"}
#: Names that stand for types where they are joined by "|".
_PLAIN_TYPES = {"None", "bool", "bytes", "dict", "float", "int", "list", "set", "str", "tuple", "type"}
#: A condition on one of these says how a module is loaded.
_LOADING = ("TYPE_CHECKING", "__name__")


def may_change(node: NodeOrLeaf, compiled: frozenset[str]) -> bool:
    """Say whether a fault may be put at a node.

    Left out are annotations, unions of types, decorators, assertions (and ``strict`` of a zip, which is one), what
    is said in sentences, machine code and its constants, and conditions of how a module is loaded.

    Parameters
    ----------
    node : parso node
    compiled : frozenset of str
        Names that compiled functions of the module look up: `compiled_names`.
    """
    if _is_union(node) or node.type == "assert_stmt":
        return False
    child = node
    while (parent := child.parent) is not None:
        if parent.type in ("decorator", "decorators", "assert_stmt") or _is_strict(parent):
            return False
        if _is_annotation(parent, child) or _is_sentence(parent) or _is_kernel(parent):
            return False
        if parent.type == "file_input" and compiled.intersection(_assigned(child)):
            return False
        child = parent
    return not (node.type == "if_stmt" and node.children[1].get_code().strip().startswith(_LOADING)) and not (
        node.parent is not None and node.get_code().strip().startswith(_LOADING)
    )


def compiled_names(tree: NodeOrLeaf) -> frozenset[str]:
    """Return the names that the compiled functions of a module contain."""
    return frozenset(
        leaf.value for node in nodes(tree) if _is_kernel(node) for leaf in nodes(node) if isinstance(leaf, Name)
    )


def nodes(tree: NodeOrLeaf) -> Iterator[NodeOrLeaf]:
    """Yield a node and all below it, each before those below it."""
    yield tree
    for child in getattr(tree, "children", ()):
        yield from nodes(child)


def _is_annotation(parent: NodeOrLeaf, child: NodeOrLeaf) -> bool:
    if parent.type in ("annassign", "tfpdef"):  # `name: annotation = value`
        return child is not parent.children[-1] or "=" not in [part.get_code().strip() for part in parent.children]
    return isinstance(parent, Function) and child is parent.annotation


def _is_sentence(node: NodeOrLeaf) -> bool:
    """Say whether a node is a formatted string with spaces in it: words for people."""
    return node.type == "fstring" and any(
        " " in part.get_code() for part in node.children if part.type == "fstring_string"
    )


def _is_strict(node: NodeOrLeaf) -> bool:
    return node.type == "argument" and node.get_code().strip().startswith("strict=")


def _is_kernel(node: NodeOrLeaf) -> bool:
    if node.type != "decorated":
        return False
    names = (leaf.value for leaf in nodes(node.children[0]) if isinstance(leaf, Name))
    return not _COMPILERS.isdisjoint(names)


def _is_union(node: NodeOrLeaf) -> bool:
    """Say whether a node is the "|" between two types."""
    if getattr(node, "value", None) != "|" or node.parent is None:
        return False
    operands = [part.get_code().strip() for part in node.parent.children if part is not node]
    return any(name in _PLAIN_TYPES or _is_class_name(name.split("[")[0].split(".")[-1]) for name in operands)


def _is_class_name(name: str) -> bool:
    return name[:1].isupper() and not name.isupper()


def _assigned(statement: NodeOrLeaf) -> list[str]:
    """Return the names that a statement at the top of a module gives values to."""
    if statement.type != "simple_stmt" or statement.children[0].type != "expr_stmt":
        return []
    first = statement.children[0].children[0]
    return [leaf.value for leaf in nodes(first) if isinstance(leaf, Name)]
