"""Random chains, what pinocchio makes of them, motions to try on them; arms to try effects on."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pinocchio as pin
import pytest
import scipy.linalg

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from arm.model import Arm, Control, Effect, Floats, Friction, Joint, Link, Sensor, Vector3

Draw = Callable[..., Arm]


@pytest.fixture(scope="session")
def dd_arm() -> Arm:
    return load_arm("dd-arm")


@pytest.fixture(scope="session")
def vertical_arm() -> Arm:
    return load_arm("dd-arm-vertical")


def triple(values: Floats) -> Vector3:
    x, y, z = np.asarray(values).tolist()
    return (x, y, z)


def point_masses(rng: np.random.Generator) -> Link:
    """Return the link that six points of mass make: whatever they are, it is a possible one."""
    mass = rng.uniform(0.1, 0.6, 6)
    place = rng.uniform(-0.3, 0.3, (6, 3)) + [0.2, 0.0, 0.0]
    squares = np.einsum("k,ki,ki->", mass, place, place)
    I = squares * np.eye(3) - np.einsum("k,ki,kj->ij", mass, place, place)  # noqa: E741
    inertia = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
    return Link(float(mass.sum()), triple(mass @ place / mass.sum()), tuple(float(x) for x in inertia))


def draw_arm(
    rng: np.random.Generator,
    n_joint: int | None = None,
    friction: bool = True,
    prismatic: bool = True,
    branching: bool = False,
) -> Arm:
    """Return an arm with 1 to 7 joints of either kind, bent every way, with two sensors on each link.

    One that branches is a tree: joints hang anywhere on a link before them, or at its far end. Branch follows
    branch, which pinocchio takes for granted.
    """
    n = int(rng.integers(1, 8)) if n_joint is None else n_joint
    joints, sensors = [], []
    for i in range(n):
        slides = prismatic and rng.random() < 0.35
        levels = rng.uniform(0.05, 0.5, 3) if friction else np.zeros(3)
        joints.append(
            Joint(
                "prismatic" if slides else "revolute",
                *rng.uniform(-2.0, 2.0, 1).tolist(),
                *rng.uniform(-0.6, 0.6, 2).tolist(),
                *rng.uniform(-2.0, 2.0, 2).tolist(),
                friction=Friction(*levels.tolist()),
                link=point_masses(rng),
            )
        )
        if branching:
            at = triple(rng.uniform(-0.5, 0.5, 3)) if rng.random() < 0.5 else None
            open_ends = [0, *(k + 1 for k in Arm("so far", tuple(joints)).way_to(i - 1))]
            joints[i] = replace(joints[i], parent=int(rng.choice(open_ends)), parent_position_m=at)
        for k in (1, 2):
            at, turned = rng.uniform(-0.4, 0.4, 3), rng.uniform(-2.0, 2.0, 3)
            sensors.append(Sensor(f"s{2 * i + k}", i + 1, triple(at), triple(turned)))
    gains = tuple(rng.uniform(5.0, 15.0, n).tolist())
    return Arm(
        "random",
        tuple(joints),
        triple(rng.uniform(-10.0, 10.0, 3)),
        tuple(sensors),
        control=Control("pd", gains, tuple(-x for x in gains)),
    )


@pytest.fixture(scope="session")
def random_arm() -> Draw:
    """Return what makes an arm from a generator: `draw_arm`."""
    return draw_arm


def draw_motion(arm: Arm, rng: np.random.Generator, n_sample: int = 5) -> tuple[Floats, Floats, Floats]:
    q = rng.uniform(-np.pi, np.pi, (n_sample, arm.n_joint))
    dq, ddq = rng.normal(size=(2, n_sample, arm.n_joint))
    return q, dq, ddq


@pytest.fixture(scope="session")
def random_motion() -> Callable[..., tuple[Floats, Floats, Floats]]:
    """Return what makes q, dq, ddq for an arm from a generator: `draw_motion`."""
    return draw_motion


@dataclass
class Peer:
    """The same arm in pinocchio, built from its own primitives and none of our formulae."""

    arm: Arm
    model: pin.Model = field(init=False)
    data: pin.Data = field(init=False)

    def __post_init__(self) -> None:
        self.model = pin.Model()
        far_ends = [pin.SE3.Identity()]
        for i, joint in enumerate(self.arm.joints):
            on = i if joint.parent is None else joint.parent
            hang = far_ends[on]
            if joint.parent_position_m is not None:
                hang = pin.SE3(np.eye(3), np.array(joint.parent_position_m))
            place = hang * pin.SE3(pin.utils.rotate("y", joint.beta_rad), np.zeros(3))
            place = place * pin.SE3(pin.utils.rotate("x", joint.alpha_rad), np.zeros(3))
            place = place * pin.SE3(pin.utils.rotate("z", joint.theta_offset_rad), np.array([0.0, 0.0, joint.d_m]))
            kind = pin.JointModelRZ() if joint.type == "revolute" else pin.JointModelPZ()
            link = self.model.addJoint(on, kind, place, f"joint{i}")
            self.model.appendBodyToJoint(link, _inertia(joint.link), pin.SE3.Identity())
            far_ends.append(pin.SE3(np.eye(3), np.array([joint.a_m, 0.0, 0.0])))
        self.model.gravity.linear = np.array(self.arm.gravity_m_s2)
        self.tip = self.model.addFrame(pin.Frame("tip", link, 0, far_ends[-1], pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def tip_load(self, q: Floats, force: Floats, moment: Floats) -> pin.StdVec_Force:
        """Return a force and moment at the tip, given in the base frame, as loads on the joints."""
        pin.framesForwardKinematics(self.model, self.data, q)
        tip = pin.SE3(np.eye(3), self.data.oMf[self.tip].translation)  # base axes, at the tip
        loads = pin.StdVec_Force([pin.Force.Zero() for _ in range(self.model.njoints)])
        loads[self.model.njoints - 1] = self.data.oMi[self.model.njoints - 1].actInv(
            tip.act(pin.Force(force, moment))
        )
        return loads

    def friction(self, dq: Floats) -> Floats:
        levels = np.array([[j.friction.viscous_N_m_s, j.friction.coulomb_N_m] for j in self.arm.joints])
        return levels[:, 0] * dq + levels[:, 1] * np.sign(dq)


def _inertia(link: Link) -> pin.Inertia:
    xx, yy, zz, xy, xz, yz = link.inertia_kg_m2
    origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    com = np.array(link.com_m)
    about_com = origin - link.mass_kg * (com @ com * np.eye(3) - np.outer(com, com))  # Steiner
    return pin.Inertia(link.mass_kg, com, about_com)


@pytest.fixture(scope="session")
def peer() -> type[Peer]:
    """Return what puts an arm into pinocchio: `Peer`."""
    return Peer


def _rubbing(arm: Arm, *levels: float) -> Arm:
    return replace(arm, joints=tuple(replace(joint, friction=Friction(*levels)) for joint in arm.joints))


def _having(arm: Arm, name: str, /, joint: int = 1, **numbers: object) -> Arm:
    on = () if catalogue()[name].whole else (joint,)
    return replace(arm, effects=(*arm.effects, Effect(name, numbers, on)))


def _linear(A: Floats, b: Floats, x0: Floats, t: Floats) -> Floats:
    whole = np.block([[A, b[:, None]], [np.zeros((1, len(b) + 1))]])
    return np.array([(scipy.linalg.expm(whole * instant) @ np.append(x0, 1.0))[: len(b)] for instant in t])


@pytest.fixture(scope="session")
def arm() -> Arm:
    """Return the spatial arm with friction, and gravity that shows where each joint's zero is."""
    return replace(_rubbing(load_arm("spatial-arm"), 0.3, 0.2, 0.0), gravity_m_s2=(2.0, 1.0, -9.5))


@pytest.fixture(scope="session")
def wheel() -> Arm:
    """Return one level joint without friction whose inertia is 0.5 kg m^2."""
    link = Link(1.0, (0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 0.0, 0.0, 0.0))
    return Arm("wheel", (Joint(a_m=0.4, link=link),), control=Control("pd", (8.0,), (-2.0,)))


@pytest.fixture(scope="session")
def having() -> Callable[..., Arm]:
    """Return what gives an arm one more effect, in one of its joints unless it is one of the whole arm."""
    return _having


@pytest.fixture(scope="session")
def rubbing() -> Callable[..., Arm]:
    """Return what gives all joints the same friction: viscous, Coulomb, static."""
    return _rubbing


@pytest.fixture(scope="session")
def held() -> Callable[[float, int], Floats]:
    """Return what makes a target of one joint that stays."""
    return lambda target, n_sample: np.full((n_sample, 1), target)


@pytest.fixture(scope="session")
def linear() -> Callable[..., Floats]:
    """Return what solves ``x' = A x + b`` from ``x0``, at every ``t``."""
    return _linear
