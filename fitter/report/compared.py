"""Other arms, compared with a calibrated one: the true arm, a published model, last month's calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from arm.arm_file import load_arm
from arm.model import Arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.evaluation import Score, score
from fitter.kinematics.tip_basis import geometry_names, geometry_of
from limbcal.errors import ConfigError


@dataclass(frozen=True)
class Compared:
    """An arm to compare with.

    Attributes
    ----------
    name : str
    arm : Arm
        With the control law of the arm that is calibrated.
    parameters : dict of str to float
        Its base parameters and static frictions.
    """

    name: str
    arm: Arm
    parameters: dict[str, float]

    def document(self, learn: Sequence[Trial], evaluate: Sequence[Trial], horizon_s: float) -> dict[str, object]:
        """Return its parameters and how well it does on the same trials, for JSON."""
        scores = {
            role: score(self.arm, trials, horizon_s) if trials else None
            for role, trials in (("learn", learn), ("evaluate", evaluate))
        }
        return {"parameters": self.parameters, **scores_document(scores)}


def scores_document(scores: dict[str, Score | None]) -> dict[str, object]:
    """Return scores by role as the JSON documents hold them."""
    return {
        "torque_rms_N_m": {role: s and list(s.torque_rms_N_m) for role, s in scores.items()},
        "angle_error_deg": {
            role: s and {"mean": s.angle_mean_deg, "max": s.angle_max_deg} for role, s in scores.items()
        },
        "explained": {role: s and list(s.explained) for role, s in scores.items()},
    }


def load_compared(sources: Sequence[str], arm: Arm) -> list[Compared]:
    """Read the arms to compare with.

    Raises
    ------
    ConfigError
        If one cannot be read or has another number of joints.
    """
    found = []
    for source in sources:
        other = load_arm(source)
        if other.n_joint != arm.n_joint:
            raise ConfigError(
                f"arm {source!r} has {other.n_joint} joints, expected {arm.n_joint} as {arm.name} has"
            )
        base = structural_parameters(other)
        values = dict(zip(base.names, (base.combination @ standard_parameters(other)).tolist(), strict=True))
        values |= {f"F{i + 1}": joint.friction.static_N_m for i, joint in enumerate(other.joints)}
        under_law = Arm(**{**vars(other), "control": arm.control})
        found.append(Compared(Path(source).stem, under_law, values))
    return found


def geometry_by_name(arm: Arm) -> dict[str, float]:
    """Return alpha1, a1, d1, beta1, theta_offset1, alpha2, … of an arm."""
    return dict(zip(geometry_names(arm.n_joint), geometry_of(arm).ravel().tolist(), strict=True))
