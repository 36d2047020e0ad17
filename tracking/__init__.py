"""Accelerations in, joint motion out."""
