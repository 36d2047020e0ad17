"""Effects that are in no catalogue: the right answer is on what they depend."""

from collections.abc import Callable
from dataclasses import replace

from benchmarks.hidden_arms.hiding import Hiding, Rng, Scene, at_joint, either_way


def outside(name: str, i: int, variables: str, numbers: Callable[[float], tuple[float, ...]]) -> Hiding:
    return replace(at_joint(name, i, numbers, "factor", most=20.0), variables=tuple(variables.split()))


def friction_by_place(rng: Rng, scene: Scene, i: int) -> Hiding:
    other = 1 if scene.n > 1 else 0
    scale = scene.torque[i] / scene.speed[i]
    variables = " ".join(sorted({"q1", f"q{other + 1}", f"dq{i + 1}"}))
    return outside("friction_by_place", i, variables, lambda s: (2.0 * scale * s, other))


def friction_by_other_angle(rng: Rng, scene: Scene, i: int) -> Hiding:
    other = (i + 1) % scene.n
    scale = either_way(rng) * scene.torque[i] / scene.speed[i]
    return outside("friction_by_other_angle", i, f"q{other + 1} dq{i + 1}", lambda s: (scale * s, other))


def coupled_drag(rng: Rng, scene: Scene, i: int) -> Hiding:
    other = (i + 1) % scene.n
    scale = either_way(rng) * scene.torque[i] / scene.speed[other]
    return outside("coupled_drag", i, f"dq{other + 1}", lambda s: (scale * s, other))


def friction_by_other_speed(rng: Rng, scene: Scene, i: int) -> Hiding:
    other = (i + 1) % scene.n
    scale = scene.torque[i] / scene.speed[other]
    variables = f"dq{other + 1} sign(dq{i + 1})"
    return outside("friction_by_other_speed", i, variables, lambda s: (scale * s, other))


def soft_wall(rng: Rng, scene: Scene, i: int) -> Hiding:
    width = rng.uniform(0.1, 0.4)
    return outside("soft_wall", i, f"q{i + 1}", lambda s: (scene.torque[i] * s, width))


def cubic_spring(rng: Rng, scene: Scene, i: int) -> Hiding:
    return outside("cubic_spring", i, f"q{i + 1}", lambda s: (scene.torque[i] / 0.5 * s,))
