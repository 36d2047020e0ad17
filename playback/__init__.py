"""Trajectories and calibrated arms out, as streams."""
