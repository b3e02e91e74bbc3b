"""Torques of every joint: the paper's outputs, the FRI target and the rest of the body in one program."""
