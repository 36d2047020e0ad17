"""Whether the sensors contradict a rigid arm, whatever drove it, and which of them, and why."""
