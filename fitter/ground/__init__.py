"""A person's masses, centres and inertias from measured ground forces: the equations of a floating base.

Nothing drives the six joints of a floating base, so what the ground does to the whole tree is all there is on
their side of eq. (4): no torque need be known (Venture, Ayusawa and Nakamura 2009).
"""
