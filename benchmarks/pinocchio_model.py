"""An arm in pinocchio, to be timed beside ours."""

import numpy as np
import pinocchio as pin

from arm.model import Arm


def pinocchio_model(arm: Arm) -> pin.Model:
    """Return joints that turn, each on its parent's far end by ``alpha_rad`` and ``a_m`` alone, in pinocchio."""
    model, far_ends = pin.Model(), [pin.SE3.Identity()]
    for i, joint in enumerate(arm.joints):
        on = i if joint.parent is None else joint.parent
        place = far_ends[on] * pin.SE3(pin.utils.rotate("x", joint.alpha_rad), np.zeros(3))
        own = model.addJoint(on, pin.JointModelRZ(), place, f"joint{i + 1}")
        inertia = pin.Inertia(joint.link.mass_kg, np.array(joint.link.com_m), 0.01 * np.eye(3))
        model.appendBodyToJoint(own, inertia, pin.SE3.Identity())
        far_ends.append(pin.SE3(np.eye(3), np.array([joint.a_m, 0.0, 0.0])))
    model.gravity.linear = np.array(arm.gravity_m_s2)
    return model
