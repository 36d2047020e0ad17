"""From bytes to accelerations: frames in order, and every sample accounted for."""
