"""The likelihood of the torque equation: base parameters, effects, and the floor of what the model lacks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.diagnosis.attenuation import noisier
from fitter.diagnosis.base_columns import BaseColumns
from fitter.diagnosis.least_squares import solved
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion, noise_of_angles, white_noise
from fitter.diagnosis.order import downstream
from fitter.diagnosis.torque.density import Density, log_density, mass_covariance, of_model, shaken
from fitter.diagnosis.torque.noise import SensorNoise, floor_of, sensor_noise, with_floor
from fitter.diagnosis.torque.spectra import BAND_SHARE, Complexes, spectra_of
from fitter.diagnosis.torque.weights import Unknown, Weights, log_variances, unknown_torques
from fitter.diagnosis.view import View, view_of

#: A perfect torque or angle has at least the noise of rounding, as a share of its rms.
_LEAST_NOISE = 1e-4
#: Share of a psi by which it is moved for a slope.
_STRIDE = 1e-4
#: Columns that are this near to depending on others, in terms of the normal equations, do so.
_DEPENDENT = 1e-12
#: Blocks of neighbouring rows last about so long [s].
BLOCK_S = 1.0
#: Weights and answer are found in turn; most of the likelihood is gained in the first few rounds.
_ROUNDS = 12
#: A round that gains less than this a trial is the last [nats].
_SETTLED = 0.1
#: Rounds in which the floor of a trial that was not fitted to is found.
_JUDGING_ROUNDS = 2
#: Steps towards the factors at each psi: from those of another psi two are enough.
_INNER = 2
#: Steps of a search for psi.
_EVALUATIONS = 12


@dataclass(frozen=True)
class System:
    """Coefficients of one motion's equations: the design's columns, and the target as the last one.

    Attributes
    ----------
    Z : (n_frequency, n_joint, n_factor + 1) complex
    noise, masses : like Z
        What a draw of the sensors' noise makes of them, and what one of white accelerations makes: the masses.
    """

    Z: Complexes
    noise: Complexes
    masses: Complexes


@dataclass(frozen=True)
class Fit:
    """A model fitted to its trials.

    Attributes
    ----------
    model : Model
    x : (n_factor,)
        Base parameters, and then the factors of the effects' columns.
    own : mapping of int to (n_frequency, n_joint, n_joint)
        Covariance of the sensors' noise under this model, by the motion's number.
    floors : mapping of int to (2, n_joint)
        See `floor_of`.
    nats : (n_block,)
        Log-likelihood of blocks of all trials, in units of what sensors' noise alone would have.
    trial : (n_block,) int
    learnt : (n_block,) bool
        Whether the trial may be learnt from.
    weights : mapping of int to Weights
        By the motion's number.
    """

    model: Model
    x: Floats
    own: Mapping[int, Floats]
    floors: Mapping[int, Floats]
    nats: Floats
    trial: NDArray[np.intp]
    learnt: NDArray[np.bool_]
    weights: Mapping[int, Weights] = field(default_factory=dict, repr=False)

    @property
    def n_number(self) -> int:
        """How many numbers its effects have."""
        return sum(one.n_number for one in self.model.hypotheses)

    @property
    def total(self) -> float:
        """Log-likelihood of all trials [nats]."""
        return float(self.nats.sum())


class TorqueLikelihood:
    """The likelihood of the torque equation.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity, law.
    motions : sequence of Motion
        Learning ones first.
    denied : tuple of str
        Beginnings of names of base parameters that are left out.
    known : (column, value), optional
        A standard parameter that is not sought.
    """

    def __init__(
        self,
        arm: Arm,
        motions: Sequence[Motion],
        denied: tuple[str, ...] = (),
        known: tuple[int, float] | None = None,
    ) -> None:
        self.arm, self.motions, self.denied, self.known = arm, list(motions), denied, known
        self.learning = [motion for motion in motions if motion.learn]
        self.sought = BaseColumns(arm, denied, known)
        self.noisier = noisier(arm, self.motions)
        self.shaken = shaken(self.motions, all("tau" in m.trial.whole and np.any(m.u) for m in motions))
        self._reference: dict[int, Density] = {}
        corner = min(*(motion.trial.cutoff_hz for motion in motions), 0.4 / max(m.dt_s for m in motions))
        self.band_hz = BAND_SHARE * corner
        self.spectra = {motion.number: spectra_of(motion, self.band_hz) for motion in motions}
        self._white_torque = self._torque_noise()
        self.holding = np.full(arm.n_joint, np.inf)
        self._unknown: dict[int, Unknown] = {}

    def _torque_noise(self) -> Floats:
        """Return the variance of the torque's white noise a sample of the motions' grid, (n_joint, n_joint)."""
        motions, arm = self.motions, self.arm
        angle = noise_of_angles([motion.trial for motion in motions])
        u = np.concatenate([motion.u for motion in motions])
        if all("tau" in motion.trial.whole for motion in motions):
            torque = white_noise([motion.trial.whole["tau"] for motion in motions])
        elif arm.control.kp and motions[0].trial.tau is None:
            torque = np.abs(arm.control.kp) * angle
        else:
            torque = np.zeros(arm.n_joint)
        thinned = np.sqrt(np.mean([motion.trial.dt_s / motion.dt_s for motion in motions]))
        least = _LEAST_NOISE * np.maximum(np.sqrt(np.mean(u**2, axis=0)), 1e-9)
        return np.diag(np.maximum(thinned * torque, least) ** 2)

    # -- equations -----------------------------------------------------------------------------------------------

    def view(self, model: Model, motion: Motion) -> View:
        """Return a motion under a model, its columns in the model's order."""
        view = view_of(motion, self.arm)
        order = downstream(model)
        for i in order:
            view = model.hypotheses[i].act(view, model.psi[i])
        return view

    def equations(self, model: Model, motion: Motion) -> Floats:
        """Return design and target on the motion's grid, (n, n_joint, n_factor + 1)."""
        view = self.view(model, motion)
        design = view.equations(self.sought.of(view.arm))
        return np.concatenate([design, view.target(self.known)[..., None]], axis=2)

    def system(self, model: Model, motion: Motion, noisy: bool = True) -> System:
        """Return the coefficients of a motion's equations, and of what a draw of noise makes of them."""
        spectra = self.spectra[motion.number]
        Z = spectra.of(self.equations(model, motion))
        if not noisy:
            return System(Z, Z[:, :, :0], Z[:, :, :0])
        loud = spectra.of(self.equations(model, self.noisier[motion.number]))
        shaken = spectra.of(self.equations(model, self.shaken[motion.number]))
        return System(Z, loud - Z, shaken - Z)

    def unknown(self, motion: Motion) -> Unknown:
        """Return what is not known of a motion's torques."""
        if motion.number not in self._unknown:
            self._unknown[motion.number] = unknown_torques(motion, self.spectra[motion.number], self.holding)
        return self._unknown[motion.number]

    def trials_of(self, model: Model) -> list[Motion]:
        """Return the trials that a model is fitted to: all of them if something in it happens in single ones."""
        return self.motions if model.is_event else self.learning

    # -- fitting -------------------------------------------------------------------------------------------------

    def sensors(self, systems: Mapping[int, System], x: Floats) -> SensorNoise:
        """Return the sensors' noise in some trials under a model, by what a draw of it leaves."""
        parts = []
        for number, system in systems.items():
            spectra = self.spectra[number]
            left = system.noise @ np.append(-x, 1.0)
            parts.append((spectra.f[1:], left[1:]))
        f, draw = (np.concatenate(column) for column in zip(*parts, strict=True))
        return sensor_noise(f, draw)

    def own(self, motion: Motion, system: System, x: Floats, sensors: SensorNoise) -> Floats:
        """Return the covariance of the sensors' noise in one trial, (n_frequency, n_joint, n_joint)."""
        f = self.spectra[motion.number].f
        draw = system.noise @ np.append(-x, 1.0)
        return sensors.of_trial(f[1:], draw[1:]).covariance(f)

    def weigh(self, motion: Motion, own: Floats, floor: Floats) -> Weights:
        """Return the weights of a motion's rows.

        Parameters
        ----------
        motion : Motion
        own : (n_frequency, n_joint, n_joint)
            Covariance of the sensors' noise.
        floor : (2, n_joint)
        """
        return Weights(with_floor(own, floor), self.unknown(motion))

    def newton(self, rows: Mapping[int, Floats], noise: Mapping[int, Floats], x: Floats | None) -> Floats:
        r"""Return the factors after one step towards those that make the motion likeliest.

        In units of the sensors' own noise the log-likelihood is

        .. math:: -\tfrac12 |y - A x|^2 + \tfrac12 \sum_f \log |S_n(f; x)|

        the second term being the density of the motion: a model that makes everything smaller makes the motion's
        noise smaller as well. Its slope is ``G x - h``, by the products of what a draw of noise makes of columns
        and target, whitened by ``S_n``. Where there is no floor this is the score of a functional
        errors-in-variables model (Stoica and Soderstrom 1982).

        Parameters
        ----------
        rows : mapping of int to (n_row, n_factor + 1)
            White by all noise.
        noise : mapping of int to (n_row, n_factor + 1)
            The draw, white by the sensors' noise.
        x : (n_factor,), optional
            Where the step begins.
        """
        gram = np.sum([one.T @ one for one in rows.values()], axis=0)
        loud = np.sum([one.T @ one for one in noise.values()], axis=0)
        A, y, G, h = gram[:-1, :-1], gram[:-1, -1], loud[:-1, :-1], loud[:-1, -1]
        size = np.sqrt(np.diag(A) + np.diag(G))
        size[size == 0.0] = 1.0
        values, axes = np.linalg.eigh((A + G) / np.outer(size, size))
        kept = values > _DEPENDENT * max(float(values.max(initial=0.0)), 1e-300)
        root = axes[:, kept] / np.sqrt(values[kept]) / size[:, None]
        if x is None:
            x = solved(A, y)
        return np.asarray(x + root @ (root.T @ (y - A @ x + G @ x - h)), dtype=np.float64)

    def floor(self, weights: Weights, own: Floats, left: Floats, start: Floats) -> Floats:
        """Return the floor of a motion by what a model leaves of it, (2, n_joint)."""
        torque = weights.torque(left[:, None])[:, :, 0]
        return floor_of(torque, own, weights.freedom, start)

    def fit(self, model: Model, start: Fit | None = None, held: int = 0, refine: bool = True) -> Fit:
        """Return a model fitted to its trials, floors and sensors' noise with it.

        Parameters
        ----------
        model : Model
        start : Fit, optional
            Of a smaller model: its weights are begun with.
        held : int
            The psi of so many hypotheses, from the first on, stay.
        refine : bool
            Whether psi is sought.
        """
        trials = self.trials_of(model)
        weights, own, floors = self._begin(trials, start)
        free = refine and len(Model(model.hypotheses[held:], model.psi[held:]).flat) > 0
        x = None if start is None else self.begun(start, model)
        for _ in range(2 if free else 1):
            if free:
                model = self.refined(model, trials, weights, own, floors, x, held)
            systems = {motion.number: self.system(model, motion) for motion in trials}
            before = -np.inf
            for _ in range(_ROUNDS):
                rows = {k: weights[k].rows(system.Z) for k, system in systems.items()}
                slopes = {m.number: self.slopes(m, systems[m.number], weights, own, floors, x) for m in trials}
                x = self.newton(rows, slopes, x)
                left = {k: one[:, -1] - one[:, :-1] @ x for k, one in rows.items()}
                sensors = self.sensors(systems, x)
                for motion in trials:
                    k = motion.number
                    own[k] = self.own(motion, systems[k], x, sensors)
                    floors[k] = self.floor(weights[k], own[k], left[k], floors[k])
                    weights[k] = self.weigh(motion, own[k], floors[k])
                total = self._total(left, weights, own, floors, systems, x)
                if abs(total - before) < _SETTLED * len(trials):
                    break
                before = total
        assert x is not None
        return self._with_nats(model, x, trials, systems, weights, own, floors)

    def slopes(
        self,
        motion: Motion,
        system: System,
        weights: Mapping[int, Weights],
        own: Mapping[int, Floats],
        floors: Mapping[int, Floats],
        x: Floats | None,
    ) -> Floats:
        """Return the rows of which the slope of a motion's density is made, (n_row, n_factor + 1)."""
        k = motion.number
        phi = of_model(floors[k], weights[k], own[k])
        plain = (
            weights[k] if not np.any(floors[k]) else self.weigh(motion, own[k], np.zeros((2, self.arm.n_joint)))
        )
        noise = plain.rows(system.noise) * np.repeat(np.sqrt(1.0 - phi).ravel(), 2)[:, None]
        if x is None or not np.any(phi > 0.0):
            return np.asarray(noise)
        root = np.linalg.cholesky(mass_covariance(system.masses @ np.append(-x, 1.0)))
        white = np.linalg.solve(root, system.masses)
        parts = np.stack([white.real, white.imag], axis=2).reshape(2 * phi.size, -1)
        share = np.repeat(np.sqrt(phi * weights[k].freedom).ravel(), 2)
        return np.vstack([noise, parts * share[:, None]])

    def density(self, motion: Motion, system: System, own: Floats, x: Floats) -> Density:
        """Return what a motion's density depends on under a model."""
        masses = mass_covariance(system.masses @ np.append(-x, 1.0))
        return Density(log_variances(own), log_variances(masses))

    def log_scale(
        self, motion: Motion, system: System, own: Floats, floor: Floats, weights: Weights, x: Floats
    ) -> float:
        """Return the logarithm of a motion's density but for its residual [nats]."""
        now = self.density(motion, system, own, x)
        reference = self._reference.get(motion.number, now)
        density = log_density(now, reference, of_model(floor, weights, own), weights.freedom)
        return density - float(np.sum(weights.freedom * weights.log_variance))

    def begun(self, start: Fit, model: Model) -> Floats:
        """Return the factors that a fit of a model begins with, by those of another one."""
        was, now = (self.sought.of(self.view(one, self.motions[0]).arm) for one in (start.model, model))
        standard = dict(zip(was.tolist(), start.x.tolist(), strict=False))
        own = {}
        at = len(was)
        for hypothesis in start.model.hypotheses:
            own[hypothesis.key] = start.x[at : at + hypothesis.n_column]
            at += hypothesis.n_column
        factors = [own.get(one.key, np.zeros(one.n_column)) for one in model.hypotheses]
        return np.concatenate([[standard.get(column, 0.0) for column in now.tolist()], *factors])

    def judged(self, fit: Fit) -> Fit:
        """Return a fit with the likelihood of all trials, those too that it was not fitted to."""
        known = self.weights_of(fit)
        weights, own, floors = dict(known), dict(fit.own), dict(fit.floors)
        others = [motion for motion in self.motions if motion.number not in floors]
        systems = {motion.number: self.system(fit.model, motion) for motion in self.motions}
        sensors = self.sensors({k: one for k, one in systems.items() if k in floors}, fit.x)
        usual = np.max(list(floors.values()), axis=0)
        for motion in others:
            k, floor = motion.number, usual
            own[k] = self.own(motion, systems[k], fit.x, sensors)
            for _ in range(_JUDGING_ROUNDS):
                weights[k] = self.weigh(motion, own[k], floor)
                left = weights[k].rows(systems[k].Z) @ np.append(-fit.x, 1.0)
                floor = self.floor(weights[k], own[k], left, floor)
            floors[k] = floor
            weights[k] = self.weigh(motion, own[k], floor)
        return self._with_nats(fit.model, fit.x, self.motions, systems, weights, own, floors)

    def _with_nats(
        self,
        model: Model,
        x: Floats,
        trials: Sequence[Motion],
        systems: Mapping[int, System],
        weights: Mapping[int, Weights],
        own: Mapping[int, Floats],
        floors: Mapping[int, Floats],
    ) -> Fit:
        blocks = []
        for motion in trials:
            k = motion.number
            left = weights[k].rows(systems[k].Z) @ np.append(-x, 1.0)
            if not model.hypotheses and k not in self._reference:
                self._reference[k] = self.density(motion, systems[k], own[k], x)
            scale = self.log_scale(motion, systems[k], own[k], floors[k], weights[k], x)
            blocks.append(self.nats(motion, left, weights[k], scale))
        count = [len(one) for one in blocks]
        return Fit(
            model,
            x,
            own,
            floors,
            np.concatenate(blocks),
            np.repeat([motion.number for motion in trials], count),
            np.repeat([motion.learn for motion in trials], count),
            weights,
        )

    def weights_of(self, fit: Fit) -> Mapping[int, Weights]:
        """Return the weights of all motions under a fit."""
        if fit.weights:
            return fit.weights
        some = [motion for motion in self.motions if motion.number in fit.floors]
        return {m.number: self.weigh(m, fit.own[m.number], fit.floors[m.number]) for m in some}

    def _begin(
        self, trials: Sequence[Motion], start: Fit | None
    ) -> tuple[dict[int, Weights], dict[int, Floats], dict[int, Floats]]:
        """Return weights, sensors' noise and floors to begin a fit with."""
        if start is not None:
            known = self.weights_of(start)
            kept = [motion.number for motion in trials]
            return {k: known[k] for k in kept}, {k: start.own[k] for k in kept}, {k: start.floors[k] for k in kept}
        thinned = np.mean([motion.trial.dt_s / motion.dt_s for motion in self.motions])
        angle = noise_of_angles([motion.trial for motion in self.motions])
        spread = np.std(np.concatenate([motion.q for motion in self.motions]), axis=0)
        turned = np.diag(thinned * np.maximum(angle, 1e-9 * np.maximum(spread, 1.0)) ** 2)
        sensors = SensorNoise(self._white_torque, turned, np.zeros(1), np.ones((1, self.arm.n_joint)))
        usual = np.mean(np.concatenate([motion.u for motion in self.motions]) ** 2, axis=0)
        floor = np.stack([np.maximum(usual, 10.0 * np.diag(self._white_torque)), np.zeros_like(usual)])
        floors = {motion.number: floor for motion in trials}
        own = {motion.number: sensors.covariance(self.spectra[motion.number].f) for motion in trials}
        return {m.number: self.weigh(m, own[m.number], floor) for m in trials}, own, floors

    def _total(
        self,
        left: Mapping[int, Floats],
        weights: Mapping[int, Weights],
        own: Mapping[int, Floats],
        floors: Mapping[int, Floats],
        systems: Mapping[int, System],
        x: Floats,
    ) -> float:
        """Return the log-likelihood of some motions [nats]."""
        by_number = {motion.number: motion for motion in self.motions}
        return sum(
            self.log_scale(by_number[k], systems[k], own[k], floors[k], weights[k], x) - 0.5 * float(one @ one)
            for k, one in left.items()
        )

    def n_block(self, motion: Motion) -> int:
        """Return how many blocks a motion has."""
        return max(2, round(len(motion.t) * motion.dt_s / BLOCK_S))

    def nats(self, motion: Motion, left: Floats, weights: Weights, log_scale: float) -> Floats:
        """Return the log-likelihood of a motion block by block, (n_block,)."""
        series = self.spectra[motion.number].in_time(weights.coefficients(left[:, None])[:, :, 0])
        blocks = np.array_split(np.sum(series**2, axis=1), self.n_block(motion))
        n = sum(len(one) for one in blocks)
        return np.array([-0.5 * one.sum() + log_scale * len(one) / n for one in blocks])

    def refined(
        self,
        model: Model,
        trials: Sequence[Motion],
        weights: Mapping[int, Weights],
        own: Mapping[int, Floats],
        floors: Mapping[int, Floats],
        x: Floats | None,
        held: int,
        evaluations: int = _EVALUATIONS,
    ) -> Model:
        """Return a model with the free psi that leave least, the weights as they are (variable projection)."""
        free = Model(model.hypotheses[held:], model.psi[held:])
        low = np.concatenate([np.zeros(0), *(one.low for one in free.hypotheses)])
        high = np.concatenate([np.zeros(0), *(one.high for one in free.hypotheses)])
        begin = np.clip(free.flat, low + 1e-12, high - 1e-12)

        def at(flat: Floats) -> Model:
            return replace(model, psi=(*model.psi[:held], *free.at(flat).psi))

        def left(flat: Floats) -> Floats:
            systems = {motion.number: self.system(at(flat), motion) for motion in trials}
            rows = {k: weights[k].rows(system.Z) for k, system in systems.items()}
            best, slopes = x, dict[int, Floats]()
            for _ in range(_INNER):
                slopes = {m.number: self.slopes(m, systems[m.number], weights, own, floors, best) for m in trials}
                best = self.newton(rows, slopes, best)
            # Half the logarithm of what draws leave is the density of the motion; it has the weights' size at x.
            solution = np.append(np.zeros(0) if best is None else -best, 1.0)
            loud = [one @ solution for one in slopes.values()]
            scale = sum(float(one @ one) for one in loud) / sum(len(one) for one in rows.values())
            return np.asarray(np.concatenate([one @ solution for one in rows.values()]) / np.sqrt(scale))

        found = scipy.optimize.least_squares(
            left,
            begin,
            bounds=(low, high),
            x_scale=np.maximum(np.abs(begin), 1e-3),
            diff_step=np.array(_STRIDE),
            max_nfev=evaluations,
            xtol=1e-5,
            ftol=1e-6,
        )
        return at(found.x)
