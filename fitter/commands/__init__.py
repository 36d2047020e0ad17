"""The commands of `fitter`, one file each."""
