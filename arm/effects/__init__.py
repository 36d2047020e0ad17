"""The catalogue of effects that an arm may show beyond rigid links and plain friction; one file each."""
