"""A motion as it may have been: how well a tracker knows it, instants and motions hanging together as they do."""

from dataclasses import dataclass

from arm.model import Floats

#: Number of draws of the errors: 64 give a standard deviation to 9 %.
DRAWS = 64


@dataclass(frozen=True)
class Draws:
    """A motion as it may have been: what was found, less one draw of its errors each.

    Attributes
    ----------
    q, dq, ddq : (n_draw, n, n_joint)
    points : (n_draw, n, n_sensor, 3) [m]
        Dead reckoning of the sensors that were asked for.
    """

    q: Floats
    dq: Floats
    ddq: Floats
    points: Floats

    def rows(self, part: slice) -> "Draws":
        """Return some instants of all draws."""
        return Draws(self.q[:, part], self.dq[:, part], self.ddq[:, part], self.points[:, part])
