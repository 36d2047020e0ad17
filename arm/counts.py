"""What the bench's sensors count: for programs that have no other use for the bench, and none for a compiler."""

from arm.model import STANDARD_GRAVITY_M_S2

#: What 16 bits span, to either side.
FULL_SCALE_M_S2 = 5.0 * STANDARD_GRAVITY_M_S2
COUNT_M_S2 = FULL_SCALE_M_S2 / 32768
