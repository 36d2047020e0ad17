"""What the drives of the joints do from sample to sample: whether they are engaged, and gains of a trial's own."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.control import gains
from arm.model import Control, Floats
from limbcal.errors import ConfigError

#: Rows of `DriveState.schedule`: kp, kv, ka of eq. (5), (6), (7), and 1 where the drive is engaged.
KP, KV, KA, ON = range(4)
N_ROW = 4

#: What data call the state of a drive, and gains that are a trial's own.
_ROLES = ("on", "kp", "kv")


@dataclass(frozen=True)
class DriveState:
    """The state of the joints' drives, sample by sample.

    Attributes
    ----------
    on : ndarray of bool, shape (n_sample, n_joint)
        Where a drive is engaged; one that is not gives no torque.
    kp, kv : ndarray of shape (n_sample, n_joint), or None
        Gains that overrule those of the control law.
    """

    on: NDArray[np.bool_]
    kp: Floats | None = None
    kv: Floats | None = None

    def rows(self, which: slice | NDArray[np.intp]) -> "DriveState":
        """Return the state at some of the samples."""
        kp, kv = (None if gain is None else gain[which] for gain in (self.kp, self.kv))
        return DriveState(self.on[which], kp, kv)

    def schedule(self, control: Control) -> Floats:
        """Return the gains of the law at every sample, zero where the drive is not engaged.

        Parameters
        ----------
        control : Control
            Gains that the samples do not give are its own. Of law "measured" there are none.

        Returns
        -------
        (n_sample, 4, n_joint)
            In the order kp, kv, ka, on.

        Raises
        ------
        ConfigError
            If a gain is neither here nor in the law, or is here and of no use to the law.
        """
        n_sample, n_joint = self.on.shape
        table = np.zeros((n_sample, N_ROW, n_joint))
        if control.law != "measured":
            own = {name: gain for name, gain in (("kp", self.kp), ("kv", self.kv)) if gain is not None}
            if "kv" in own and control.law == "p" and own["kv"].any():
                raise ConfigError("the data say kv1…, but control.law is 'p'; expected 'pd', which has kv")
            blank = {name: (0.0,) * n_joint for name in own}
            table[:, :ON] = gains(replace(control, **blank), n_joint)
            for row, name in ((KP, "kp"), (KV, "kv")):
                if name in own:
                    table[:, row] = own[name]
        table[:, ON] = 1.0
        return np.asarray(table * self.on[:, None, :], dtype=np.float64)

    def torque(self, control: Control, q: Floats, dq: Floats, ddq: Floats, ref: Floats) -> Floats:
        """Return the torque that a control law asks of the drives that are engaged, eq. (5), (6), (7).

        Parameters
        ----------
        control : Control
        q, dq, ddq, ref : (n_sample, n_joint)

        Returns
        -------
        (n_sample, n_joint) [N m or N]
        """
        law = self.schedule(control)
        tau: Floats = law[:, KP] * (ref - q) + law[:, KV] * dq + law[:, KA] * ddq
        return tau


def unchanging(n_joint: int) -> Floats:
    """Return the schedule of drives that are what the law says throughout: it has no samples."""
    return np.empty((0, N_ROW, n_joint))


def drives_of(columns: Mapping[str, Floats]) -> DriveState | None:
    """Return the state of the drives that some columns say; None where they say no more than ``[control]`` does.

    Parameters
    ----------
    columns : mapping of str to ndarray of shape (n_sample, n_joint)
        By role; ``on`` (0 or 1), ``kp`` and ``kv`` count, where there are any.
    """
    on, kp, kv = (columns.get(role) for role in _ROLES)
    if kp is None and kv is None and (on is None or bool(on.all())):
        return None
    shape = next(values.shape for values in (on, kp, kv) if values is not None)
    return DriveState(np.ones(shape, dtype=np.bool_) if on is None else on > 0.5, kp, kv)
