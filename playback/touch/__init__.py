"""Touching the calibrated arm: it is simulated in real time, pulled by a hand, and pulls back (docs/touch.md)."""
