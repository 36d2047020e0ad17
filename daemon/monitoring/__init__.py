"""How the daemon is doing: health reports, alarms, notifications."""
