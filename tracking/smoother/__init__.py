"""A whole recording at once: motions, sensors that calibrate themselves, what the model lacks."""
