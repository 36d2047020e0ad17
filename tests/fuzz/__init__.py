"""What arrives from outside, whatever it is: no crash, no hang, memory bounded."""
