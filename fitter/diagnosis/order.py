"""In what order hypotheses act: from the drive to the link, whatever order they were found in.

Friction by load is that of the torque that arrives. Those that no other one acts on come first or last.
"""

from fitter.diagnosis.model import Model

#: What no torque enters, and then what acts on the torque before columns are made of it, in this order; the rest
#: follows. A limit is the same before a delay and after it, but before it the torque is as sharp as asked for.
_UPSTREAM = (
    *("backlash", "gravity_tilt", "joint_zero"),
    *("gain_error", "torque_saturation", "actuator_delay", "actuator_lag"),
)
#: What depends on how large the torque is that arrives. Beside nothing of these a gain comes last.
_FEEL_TORQUE = ("torque_saturation", "joint_elasticity", "load_friction")


def scales_only(model: Model) -> bool:
    """Say whether a gain in a model does no more than scale what its joint resists with: nothing feels it."""
    return not any(hypothesis.kind.name in _FEEL_TORQUE for hypothesis in model.hypotheses)


def downstream(model: Model) -> list[int]:
    """Return the places of a model's hypotheses in the order in which they act; of those with columns it stays."""
    gain_last = scales_only(model)

    def turn(k: int) -> int:
        hypothesis = model.hypotheses[k]
        name, rest = hypothesis.kind.name, len(_UPSTREAM)
        if name == "thermal_drift" or (name == "gain_error" and gain_last):  # they scale what is there
            return rest + 2 + (name == "gain_error")
        if hypothesis.n_column:
            return rest + 1
        return _UPSTREAM.index(name) if name in _UPSTREAM else rest

    return sorted(range(len(model.hypotheses)), key=turn)
