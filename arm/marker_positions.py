"""Where optical markers on an arm are at given joint values."""

from arm.kinematics import positions_on_links
from arm.model import Arm, Floats


def marker_positions(arm: Arm, q: Floats) -> Floats:
    """Return where an arm has its markers in frame 0.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_marker, 3) [m]
        In the order of the arm's markers; those of link 0 stand.
    """
    return positions_on_links(arm, q, arm.markers)
