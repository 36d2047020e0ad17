"""What the bench's sensors count: for programs that have no other use for the bench, and none for a compiler."""

import math

from arm.model import STANDARD_GRAVITY_M_S2

#: What 16 bits span, to either side.
FULL_SCALE_M_S2 = 5.0 * STANDARD_GRAVITY_M_S2
COUNT_M_S2 = FULL_SCALE_M_S2 / 32768
#: The same of gyroscopes: two thousand degrees a second, as chips have it.
FULL_SCALE_RAD_S = math.radians(2000.0)
COUNT_RAD_S = FULL_SCALE_RAD_S / 32768
