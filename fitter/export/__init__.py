"""A calibrated arm and its motion as files of OpenSim (model, MOT, TRC) and biorbd (bioMod)."""
