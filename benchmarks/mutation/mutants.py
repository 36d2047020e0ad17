"""The faults: which there are, a sample of them, and the code that has one."""

import ast
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import parso
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

from benchmarks.mutation.places import compiled_names, may_change, nodes

#: Of all that cosmic-ray can replace by all else: what a slip of the hand would, and what an edge case needs.
_SLIPS = {
    "ReplaceBinaryOperator": (
        *("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "FloorDiv_Div", "Mod_FloorDiv", "Pow_Mul"),
        *("LShift_RShift", "RShift_LShift", "BitAnd_BitOr", "BitOr_BitAnd", "BitXor_BitAnd"),
    ),
    "ReplaceComparisonOperator": (
        *("Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE", "GtE_Gt", "GtE_Lt"),
        *("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"),
    ),
    "ReplaceUnaryOperator": ("Delete_USub", "Delete_Not", "Delete_Invert"),
}
_OTHERS = (
    *("AddNot", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd"),
    *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ExceptionReplacer", "NumberReplacer"),
    "ZeroIterationForLoop",
)
OPERATORS = (*(f"{kind}_{slip}" for kind, slips in _SLIPS.items() for slip in slips), *_OTHERS)
#: Parents of a "*", "**" or "/" that multiplies and divides nothing.
_NO_OPERANDS = {"parameters", "dictorsetmaker", "atom", "typedargslist", "lambdef"}


@dataclass(frozen=True)
class Mutant:
    """One fault: what an operator of cosmic-ray does at one of the places where it can."""

    path: str
    line: int
    column: int
    operator: str
    occurrence: int

    @property
    def key(self) -> str:
        """What a results file calls it."""
        return f"{self.path}:{self.line}:{self.column} {self.operator} {self.occurrence}"


def mutants_of(path: str, code: str) -> Iterator[Mutant]:
    """Yield all faults that may be put into a file."""
    tree = parso.parse(code)
    compiled = compiled_names(tree)
    every = list(nodes(tree))
    for name in OPERATORS:
        operator, occurrence = _operator(name), 0
        for node in every:
            places = list(operator.mutation_positions(node))
            if places and _has_operands(name, node) and may_change(node, compiled):
                for k, (begin, end) in enumerate(places):
                    if name != "ExceptionReplacer" or _is_one_name(node, begin, end):
                        yield Mutant(path, *begin, name, occurrence + k)
            occurrence += len(places)


def sample(root: Path, paths: Sequence[str], count: int, seed: int) -> list[Mutant]:
    """Draw faults that change what Python runs: any place is as likely as any other, and has at most one fault."""
    places: dict[tuple[str, int, int], list[Mutant]] = {}
    for path in paths:
        for mutant in mutants_of(path, (root / path).read_text(encoding="utf-8")):
            places.setdefault((path, mutant.line, mutant.column), []).append(mutant)
    drawn = random.Random(seed)
    order = sorted(places)
    drawn.shuffle(order)
    found: list[Mutant] = []
    for place in order:
        if len(found) == count:
            break
        mutant = drawn.choice(places[place])
        code = (root / mutant.path).read_text(encoding="utf-8")
        if _differ(code, mutated(code, mutant)):
            found.append(mutant)
    return found


def mutated(code: str, mutant: Mutant) -> str:
    """Return code with a fault."""
    changed = mutate_code(code, _operator(mutant.operator), mutant.occurrence)
    assert isinstance(changed, str), mutant
    return changed


def change(code: str, changed: str) -> str:
    """Return the line where two codes differ first, before and after."""
    pairs = zip(code.splitlines(), changed.splitlines(), strict=False)
    old, new = next((pair for pair in pairs if pair[0] != pair[1]), ("", ""))
    return f"{old.strip()} → {new.strip()}"


def _has_operands(name: str, node: parso.tree.NodeOrLeaf) -> bool:
    return not name.startswith("ReplaceBinary") or node.parent.type not in _NO_OPERANDS


def _is_one_name(node: parso.tree.NodeOrLeaf, begin: tuple[int, int], end: tuple[int, int]) -> bool:
    """Say whether there is one name at a place, and not one of a module's, which cosmic-ray cannot replace."""
    leaf = node.get_leaf_for_position(begin, include_prefixes=True)
    return leaf is not None and (leaf.start_pos, leaf.end_pos) == (begin, end)


def _differ(code: str, changed: str) -> bool:
    """Say whether changed code can be loaded, and is not the same to Python."""
    try:
        return ast.dump(ast.parse(changed)) != ast.dump(ast.parse(code))
    except SyntaxError:
        return False


@cache
def _operator(name: str) -> object:
    return get_operator(f"core/{name}")()
