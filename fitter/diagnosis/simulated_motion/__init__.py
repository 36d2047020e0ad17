"""How far an arm's simulated motion goes astray, and its numbers moved until it does least."""
