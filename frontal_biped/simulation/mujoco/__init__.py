"""The same robot in MuJoCo, whose contact nobody here wrote (extra ``mujoco``)."""
