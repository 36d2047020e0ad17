"""The device's clock: ticks counted, ticks per sample, and UTC of a tick."""
