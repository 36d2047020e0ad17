"""Effects hidden in measured recordings: their torque is added to the measured one."""
