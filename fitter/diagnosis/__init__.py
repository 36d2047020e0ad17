"""What a calibrated simulation gets wrong, why, and the gain of putting it right."""
