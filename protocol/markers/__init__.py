"""Optical markers: recordings as they come, what is wrong with them, and what can be put right."""
