"""An arm file with every table of schema 1."""

EFFECT = """[[effect]]                                  # what a diagnosis added to the simulation
name = "gravity_tilt"
parameters = { gx_m_s2 = 0.31, gy_m_s2 = -0.12 }
"""

EVERYTHING = """
schema = 1
name = "dd-arm"
gravity_m_s2 = [0.0, 0.0, -9.80665]        # in the base frame; the DD arm moves in the x-y plane

[[joint]]
type = "revolute"                           # or "prismatic"
alpha_rad = 0.0
a_m = 0.25
d_m = 0.0
beta_rad = 0.0
theta_offset_rad = 0.0
length_std_m = 0.0005                       # how well a_m and d_m are known; left out: guesses
friction = { viscous_N_m_s = 0.0, coulomb_N_m = 0.0, static_N_m = 0.0 }
link = { mass_kg = 1.0, com_m = [0.1, 0.0, 0.0], inertia_kg_m2 = [0.01, 0.01, 0.02, 0.0, 0.0, 0.0] }

[[joint]]
parent = 1                                  # the link that it hangs on; 0: the base; left out: the link before
parent_position_m = [0.2, 0.0, 0.05]        # where on it, in its joint-axis frame; left out: its far end

[[sensor]]                                  # a triaxial accelerometer
name = "s1"
joint = 1                                   # the link it rides on
position_m = [0.10, 0.0, 0.0]               # in the link's joint-axis frame
rotation_rad = [0.0, 0.0, 0.0]              # link -> sensor, roll pitch yaw
scale = [1.002, 0.998, 1.0]                 # what it reads for one m/s^2
bias_m_s2 = [0.01, -0.02, 0.0]              # what it reads for none
highpass_hz = 0.1                           # the corner of an AC-coupled one; 0: DC

[[sensor]]
name = "s4"
joint = 2

[tip]                                       # what measures r*
sensor = "s4"
offset_m = [0.02, 0.0, 0.0]                 # in the link's frame

[base_parameters]                           # what a calibration really identified: value and standard error
"I1+m2*L1^2" = { value = 1.986076, std = 0.0004 }

[[effect]]                                  # what a diagnosis added to the simulation
name = "gravity_tilt"
parameters = { gx_m_s2 = 0.31, gy_m_s2 = -0.12 }

[base]                                      # where frame 0 stands in the world
position_m = [0.0, 0.1, 0.9]
rotation_rad = [0.0, 0.1, 0.0]
segment = "scapula_right"                   # a tracked segment carries it

[[marker]]                                  # an optical marker
name = "RUS"
joint = 2                                   # the link it rides on; 0: the base
position_m = [0.01, 0.02, 0.25]
std_m = 0.006

[body]                                      # whose arm or leg it is
preset = "human-arm-right"
mass_kg = 70.0
height_m = 1.75
sex = "f"

[control]                                   # eq. (5), (6), (7): tau = kp (ref - q) + kv dq + ka ddq
law = "pd"                                  # "pd" (5), "pda" (6), "p" (7), or "measured"
kp = [9.5, 9.5]
kv = [-9.5, -9.5]
"""
