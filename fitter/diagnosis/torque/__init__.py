"""The torque equation: its likelihood, the torque that is missing in it, and pulses in that."""
