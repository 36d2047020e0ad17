"""Data that contradict themselves: every table is looked at before a fit, one kind of question a file.

A question is decided by physics where the table holds evidence (a velocity with an angle, a torque or a tip that
the angles must explain) and by how large such numbers usually are where it holds none; the usual sizes are in
`magnitude`. What can be put right is put right and noted; what would make the answer useless is refused with the
likely cause. A column whose unit is stated is never asked about its unit.
"""
