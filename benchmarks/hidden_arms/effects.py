"""All effects that can be hidden, and where each could be seen."""

from collections.abc import Callable

from benchmarks.hidden_arms.at_joint import (
    air_drag,
    cogging,
    coulomb_asymmetry,
    end_stop,
    external_push,
    joint_spring,
    load_friction,
    periodic_disturbance,
    quadratic_drag,
    stribeck,
    thermal_drift,
    torque_offset,
)
from benchmarks.hidden_arms.hiding import Hiding, Rng, Scene
from benchmarks.hidden_arms.in_arm import gravity_tilt, joint_zero, payload, rotor_inertia, stiction
from benchmarks.hidden_arms.in_drive import (
    actuator_delay,
    actuator_lag,
    backlash,
    gain_error,
    joint_elasticity,
    torque_saturation,
)
from benchmarks.hidden_arms.outside import (
    coupled_drag,
    cubic_spring,
    friction_by_other_angle,
    friction_by_other_speed,
    friction_by_place,
    soft_wall,
)

Draw = Callable[[Rng, Scene, int], Hiding]


EFFECTS: dict[str, Draw] = {
    draw.__name__: draw
    for draw in (
        actuator_delay,
        actuator_lag,
        air_drag,
        backlash,
        cogging,
        coulomb_asymmetry,
        end_stop,
        external_push,
        gain_error,
        gravity_tilt,
        joint_elasticity,
        joint_spring,
        joint_zero,
        load_friction,
        payload,
        periodic_disturbance,
        quadratic_drag,
        rotor_inertia,
        stiction,
        stribeck,
        thermal_drift,
        torque_offset,
        torque_saturation,
    )
}


OUTSIDE: dict[str, Draw] = {
    draw.__name__: draw
    for draw in (
        friction_by_place,
        friction_by_other_angle,
        coupled_drag,
        friction_by_other_speed,
        soft_wall,
        cubic_spring,
    )
}


#: These show at other joints than their own, or at all of them.
WHOLE = {"gravity_tilt", "payload", "joint_zero"}


#: One joint alone takes these for its own inertia or weight.
NEEDS_TWO = {
    "air_drag",
    "gravity_tilt",
    "gain_error",
    "joint_zero",
    "rotor_inertia",
    "friction_by_other_angle",
    "coupled_drag",
    "friction_by_other_speed",
}


def joints_for(name: str, scene: Scene) -> list[int]:
    """Return the joints, from 0, at which an effect could be seen in such an arm; none if it couldn't."""
    n, everywhere = scene.n, list(range(scene.n))
    if n == 1 and name in NEEDS_TWO:
        return []
    if name == "joint_zero":
        seen = [] if scene.level else [0]
        return [*seen, 1] if n > 2 else seen
    if name in ("air_drag", "rotor_inertia"):
        return everywhere[1:]
    if name in ("stiction", "thermal_drift"):
        rubs = scene.arm.friction[:, 1] > 0.015 * scene.torque
        return [i for i in everywhere if rubs[i]]
    return everywhere
