"""How long a test waits for what must come: it bounds a hang, and says nothing of how fast a machine is."""

#: Never reached where all is well, however busy the processors are with other programs.
PATIENCE_S = 600.0
PATIENCE_MS = 600_000
