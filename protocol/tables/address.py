"""The way to a column within a tree of names, lists and arrays, as ``.mat`` and JSON files hold.

An address is ``name``, ``name.field`` (of a struct, an object, or of every record in a list), ``name[k]`` (row or
column k of a table, whichever is not time; number k of a row of gains) or ``name(k)`` (cell k of a cell array or
element k of a list). Everything is counted from 1, as ``{j}`` is. A list of tables without ``(k)`` is a set of
motions, one a cell, and ``(a:b)`` are some of them; ``(join)`` and ``(join a:b)`` put cells end to end to the one
motion that they are.
"""

import re
from collections.abc import Mapping

import numpy as np

from limbcal.errors import DataError
from protocol.tables.trees import Array, Node, fields_of

_STEP = re.compile(r"\.(?P<field>[^.\[\](){}]+)|\[(?P<row>[^\]]*)\]|\((?P<cell>[^)]*)\)")
_HEAD = re.compile(r"[^.\[\](){}]+")
#: Some cells, or all of them, kept apart or joined.
_CELLS = re.compile(r"(?P<join>join)?\s*(?:(?P<first>\d*)\s*:\s*(?P<last>\d*))?")


def reached(root: Node, address: str, where: str, is_row: bool = False) -> Node:
    """Return what an address leads to: an array, or a list of cells.

    Parameters
    ----------
    root : Node
        The tree.
    address : str
    where : str
        File and address, for errors.
    is_row : bool
        What has one row and several columns is no table, but numbers for every row of a motion: ``[k]`` is one.

    Raises
    ------
    DataError
        If it leads nowhere.
    """
    if address in fields_of(root):  # a name may have brackets in it
        return _field(root, address, where)
    head = head_of(address)
    if not head:
        raise DataError(f"{where}: expected the name of an array first")
    return _walked(_field(root, head, where), address[len(head) :], where, is_row)


def head_of(address: str) -> str:
    """Return the name that an address begins with; nothing if it begins with none."""
    head = _HEAD.match(address)
    return head[0] if head else ""


def last_name(address: str) -> str:
    """Return the last name in an address."""
    names = [step["field"] for step in _STEP.finditer(address) if step["field"]]
    return names[-1] if names else head_of(address) or address


def row_of(node: Node, where: str, may_be_one: bool = False) -> Array:
    """Return a node as one row of values.

    Raises
    ------
    DataError
        If it is none.
    """
    if not isinstance(node, np.ndarray):
        raise DataError(f"{where}: holds fields or cells, expected an array; name a field or a cell of it")
    if (node.ndim == 0 and not may_be_one) or max(node.shape, default=1) != node.size:
        raise DataError(f"{where}: has shape {node.shape}, expected a row of numbers; name one with [k]")
    return node.ravel()


def _walked(node: Node, steps: str, where: str, is_row: bool) -> Node:
    """Return what the rest of an address leads to."""
    place = 0
    while place < len(steps):
        step = _STEP.match(steps, place)
        if step is None:
            raise DataError(f"{where}: cannot read {steps[place:]!r}, expected .field, [k], (k), (a:b) or (join)")
        place = step.end()
        if step["field"] is not None:
            node = _field(node, step["field"], where)
        elif step["row"] is not None:
            node = _row(node, _index(step["row"], where), where, is_row)
        elif (several := _CELLS.fullmatch(step["cell"].strip())) is not None and step["cell"].strip():
            some = _some(node, several, where)
            inner = [_walked(cell, steps[place:], f"{where}, cell {k}", is_row) for k, cell in some]
            if several["join"] is None:
                return inner
            return np.concatenate([row_of(one, where) for one in inner])
        else:
            node = _cell(node, _index(step["cell"], where), where)
    return node


def _some(node: Node, wanted: re.Match[str], where: str) -> list[tuple[int, Node]]:
    """Return the cells that are wanted, with their numbers."""
    if not isinstance(node, list):
        raise DataError(f"{where}: ({wanted[0]}) of something with no cells")
    first, last = int(wanted["first"] or 1), int(wanted["last"] or len(node))
    if not 1 <= first <= last <= len(node):
        raise DataError(f"{where}: ({wanted[0]}) of something with {len(node)} cells, expected some of them")
    return [(k, node[k - 1]) for k in range(first, last + 1)]


def _field(node: Node, name: str, where: str) -> Node:
    fields = fields_of(node)
    if name not in fields:
        there = f"one of {', '.join(fields)}" if fields else "an array, for it has no fields"
        raise DataError(f"{where}: there is no {name!r}, expected {there}")
    if isinstance(node, Mapping):
        return fields[name]
    column: list[Node] = []
    for row, record in enumerate(node):
        if not isinstance(record, Mapping) or name not in record:
            raise DataError(f"{where}: record {row + 1} has no {name!r}, expected it in every record")
        column.append(record[name])
    return _gather(column)


def _gather(nodes: list[Node]) -> Node:
    """Make one column of a list of single values; leave a list of anything else a list."""
    if nodes and all(isinstance(node, np.ndarray) and node.ndim == 0 for node in nodes):
        return np.array([node.item() for node in nodes if isinstance(node, np.ndarray)])
    return nodes


def _row(node: Node, k: int, where: str, is_row: bool) -> Node:
    if isinstance(node, list):
        return [_row(cell, k, where, is_row) for cell in node]
    if is_row and isinstance(node, np.ndarray) and (node.ndim == 1 or (node.ndim == 2 and 1 in node.shape)):
        numbers: Array = node.ravel()
        if not 1 <= k <= len(numbers):
            raise DataError(f"{where}: [{k}] of a row of {len(numbers)} numbers, expected 1 to {len(numbers)}")
        return numbers[k - 1 : k].reshape(())
    if not isinstance(node, np.ndarray) or node.ndim != 2:
        found = f"shape {node.shape}" if isinstance(node, np.ndarray) else "fields"
        raise DataError(f"{where}: [{k}] of something with {found}, expected a table of two dimensions")
    table = node if node.shape[0] < node.shape[1] else node.T  # the longer side is time
    if not 1 <= k <= len(table):
        raise DataError(f"{where}: [{k}] of a table with {len(table)} rows, expected 1 to {len(table)}")
    row: Array = table[k - 1]
    return row


def _cell(node: Node, k: int, where: str) -> Node:
    if not isinstance(node, list) or not 1 <= k <= len(node):
        held = f"{len(node)} cells, expected 1 to {len(node)}" if isinstance(node, list) else "no cells"
        raise DataError(f"{where}: ({k}) of something with {held}")
    return node[k - 1]


def _index(text: str, where: str) -> int:
    if not text.strip().isdigit():
        raise DataError(f"{where}: {text!r} is no index, expected a whole number from 1")
    return int(text)
