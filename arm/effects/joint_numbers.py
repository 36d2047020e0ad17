"""What a compiled simulation knows of each joint's effects as plain numbers, and in which order."""

#: Delay [s], time constant [s], factor, limit [N m], gap [rad], stiffness, damping and rotor inertia.
DELAY, LAG, FACTOR, LIMIT, GAP, STIFFNESS, DAMPING, ROTOR = range(8)
N_NUMBER = 8
