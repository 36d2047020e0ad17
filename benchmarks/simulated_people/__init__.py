"""People whose bones, masses and motion are known: markers on them, forces beneath them."""
