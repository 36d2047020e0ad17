"""An arm that is being calibrated, motion after motion: geometry always, dynamics after each learning motion."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from arm.model import Arm
from fitter.data.estimated_again import estimated_again, follower_of
from fitter.data.first_rest import displacement
from fitter.data.measured_tip import with_measured_tip
from fitter.data.motions import Measured, require_rising
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.evaluation import Score, score
from fitter.dynamics.fit import fit_dynamics
from fitter.kinematics.found_geometry import fit_of
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.kinematics_fit import KinematicsFit
from fitter.kinematics.tip_error import TipScore, tip_score
from limbcal.errors import DataError, LimbcalError

#: Generations that are bred on a new motion before the best geometry is brought to its optimum.
_LITTER = 26
#: Generations without new frames after which the search for the geometry rests.
GENERATIONS = 500


@dataclass
class Calibration:
    """What was learnt of an arm so far, and from what.

    Attributes
    ----------
    arm : Arm
        As described by its file.
    learn, evaluate : list of Trial
    geometry : IncrementalKinematics
    dynamics : DynamicsFit or None
    doubt : str
        Why the dynamics could not be learnt last time; empty where they could.
    """

    arm: Arm
    seed: int = 0
    learn: list[Trial] = field(default_factory=list)
    evaluate: list[Trial] = field(default_factory=list)
    dynamics: DynamicsFit | None = None
    doubt: str = ""

    def __post_init__(self) -> None:
        self.geometry = IncrementalKinematics(self.arm, self.seed)
        self._fresh = 0
        self._known: KinematicsFit | None = None
        self._follower = follower_of(self.arm, self.seed)

    def add(self, motion: Measured) -> Trial:
        """Take in a motion: its frames go into the sums of the geometry if it is a learning one.

        Raises
        ------
        DataError
            If the motion is too short, not one of this arm, or not made of numbers.
        """
        found = motion.columns["q"].shape[1]
        if found != self.arm.n_joint:
            raise DataError(f"frames of {found} joint angles, expected {self.arm.n_joint} as {self.arm.name} has")
        for name, values in motion.columns.items():
            if not np.isfinite(values).all():
                raise DataError(f"{name} holds a value that is not finite, expected numbers")
        require_rising(motion)
        motion = estimated_again(self._follower, motion)
        pieces = to_trials([motion], cutoff_hz=np.inf)  # several where messages were missed
        trial = max(pieces, key=lambda piece: len(piece.t))
        trial = with_measured_tip(self.arm, trial) if self.arm.tip is not None else trial
        if trial.role == "evaluate":
            self.evaluate.append(trial)
            return trial
        self.learn.append(trial)
        self._add_to_geometry(trial, len(self.learn))
        return trial

    def _add_to_geometry(self, trial: Trial, number: int) -> None:
        if trial.tip is not None:
            moved, rest = displacement(self.arm, trial)
            self.geometry.add(trial.q, moved, rest, trial=number)
            self._fresh = GENERATIONS

    @property
    def learnt(self) -> bool:
        """Whether anything at all is known of the arm that its file does not say."""
        return self.dynamics is not None or self.kinematics() is not None

    def breed(self) -> bool:
        """Breed one generation of geometries; False where there is nothing new to breed on."""
        if self._fresh <= 0:
            return False
        self._fresh -= 1
        self.geometry.generation()
        return True

    def kinematics(self) -> KinematicsFit | None:
        """Return the geometry as the motions so far show it, or None as long as nothing is identifiable."""
        return self._known

    def settle_geometry(self) -> None:
        """Bring the best geometry to its optimum, and find out how well it is known."""
        if not self.geometry.samples:
            return
        for _ in range(_LITTER):
            self.breed()
        known = None
        if self.geometry.is_determined.any():
            self.geometry.polish()
            known = fit_of(self.geometry, self.learn)
        self._known = known

    def learn_dynamics(self, progress: Callable[[int, float], None] | None = None) -> None:
        """Learn geometry and then dynamics of the arm from all learning motions so far."""
        self.settle_geometry()
        fit = self.kinematics()
        try:
            self.dynamics = fit_dynamics(
                self.arm if fit is None else fit.arm,
                self.learn,
                objective="torque",
                seed=self.seed,
                examine=False,
                geometries=None if fit is None else fit.drawn,
                progress=progress,
            )
            self.doubt = ""
        except LimbcalError as error:  # one motion may be too little; the next one may be enough
            self.doubt = str(error)

    def conclude(self) -> None:
        """Search once more from the beginning, with all motions that there were, and learn the dynamics.

        How far the population has come while they came in depends on the machine; this depends on nothing but
        motions and seed. Where it is interrupted, what was known before is what is known.
        """
        before = self.geometry, self._known, self.dynamics, self.doubt
        try:
            self.geometry = IncrementalKinematics(self.arm, self.seed)
            for number, trial in enumerate(self.learn, 1):
                self._add_to_geometry(trial, number)
            while self.breed():
                pass
            if self.learn:
                self.learn_dynamics()
        except BaseException:
            self.geometry, self._known, self.dynamics, self.doubt = before
            raise

    def calibrated(self) -> Arm:
        """Return the arm as far as it is known."""
        fit = self.kinematics()
        arm = self.arm if fit is None else fit.arm
        if self.dynamics is None:
            return arm
        return replace(self.dynamics.arm, name=self.arm.name)

    def scores(self, role: str) -> tuple[Score | None, TipScore | None]:
        """Return how the calibrated arm does on the motions of one role; None where there are none."""
        trials, fit = (self.learn if role == "learn" else self.evaluate), self.kinematics()
        if not trials:
            return None, None
        moved = tip_score(fit.arm, trials) if fit is not None and trials[0].tip is not None else None
        return (score(self.calibrated(), trials) if self.dynamics is not None else None), moved
