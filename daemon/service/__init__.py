"""`limbd run` as a whole: its processes, the service manager, its files on a machine."""
