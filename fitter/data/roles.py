"""Which columns of a file play which role."""

from collections.abc import Collection, Mapping, Sequence

from fitter.data.columns import JOINT_ROLES, Address, ColumnMap
from fitter.data.tables import Columns
from limbcal.errors import DataError

Roles = dict[str, list[str]]


def find_roles(
    source: Columns,
    n_joint: int,
    mapping: ColumnMap,
    required: Collection[str],
    vectors: Mapping[str, Sequence[str]],
) -> Roles:
    """Return the addresses of every role that a file has.

    Parameters
    ----------
    source : Columns
        The opened file.
    n_joint : int
        Number of joints of the arm.
    mapping : ColumnMap
        What the user said of the columns.
    required : collection of str
        Roles that must be there.
    vectors : mapping of str to sequence of str
        Roles of several plain columns, such as ``{"tip": ("tipx", "tipy", "tipz")}``.

    Returns
    -------
    dict of str to list of str
        ``t`` and ``trial`` with one address; q, dq, ddq, tau and ref with one a joint; and the vectors.

    Raises
    ------
    DataError
        If a column that was asked for is not there, some columns of a role are missing, or there are more joints
        than the arm has.
    """
    wanted = {name: [mapping.plain(name)] for name in ("t", "trial")}
    wanted |= {role: [mapping.joint(role, number) for number in range(1, n_joint + 1)] for role in JOINT_ROLES}
    wanted |= {role: [mapping.plain(name) for name in names] for role, names in vectors.items()}
    roles: Roles = {}
    for role, addresses in wanted.items():
        asked = [address for address in addresses if address is not None]
        found = _present(source, asked, role in required) if len(asked) == len(addresses) else []
        if found:
            roles[role] = found
        elif role in required:
            raise DataError(f"{source.path}: nothing is mapped to {role!r}, which is needed")
    for role in JOINT_ROLES:
        extra = mapping.joint(role, n_joint + 1)
        if role in roles and mapping.numbers_joints(role) and extra is not None and extra.text in source.names:
            arm = f"{n_joint} joint{'' if n_joint == 1 else 's'}"
            raise DataError(f"{source.path}: there is a column {extra.text!r}, but the arm has {arm}")
    return roles


def listed(source: Columns) -> str:
    """Return the names of a file's columns in words."""
    return "its columns " + ", ".join(source.names) if source.names else "its columns (there are none)"


def _present(source: Columns, addresses: Sequence[Address], required: bool) -> list[str]:
    """Return the addresses if all of them are there; if one is, none may be missing."""
    missing = [address for address in addresses if not source.has(address.text)]
    here = [address.text for address in addresses if address not in missing]
    if missing and (here or required or missing[0].asked):
        beside = f" beside {', '.join(here)}" if here else ""
        raise DataError(f"{source.path}: no column {missing[0].text!r}{beside} among {listed(source)}")
    return here
