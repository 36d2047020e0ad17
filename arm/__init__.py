"""The arm itself: geometry, dynamics, simulation, and what a sensor on it reads."""
