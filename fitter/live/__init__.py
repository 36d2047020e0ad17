"""Calibration of an arm while its motion comes in."""
