"""A process of the daemon: how it starts, what it and the supervisor say to each other, and how it stops."""
