"""Likelihood of the torque equation, and the torque that it misses."""
