"""An arm's dynamics from motion and torque: eq. (4), (8), (9)."""
