"""From accelerations to joint motion, and what the sensors themselves are."""
