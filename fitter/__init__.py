"""Recordings and streams in, kinematics, dynamics and reports out."""
