"""The live tracker: one step of the filter, filters side by side, and what begins anew after a gap."""
