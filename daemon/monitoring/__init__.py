"""How the daemon is doing: health, alarms, and who is told of them."""
