"""An arm's geometry from joint angles and the tip: eq. (1) to (3)."""
