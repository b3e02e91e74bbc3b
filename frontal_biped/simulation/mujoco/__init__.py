"""The same robot in MuJoCo, whose contact nobody here wrote (extra ``mujoco``).

The model is built from the same URDF and description by `MjSpec`; contact, friction and impact are MuJoCo's own: a
spring and damper with a time constant of 4 ms, critically damped, physics steps of 0.5 ms, control at 1 kHz. The robot
walks under a `Walker`: joint angles, pelvis roll and foot contact flags in, torques out. It estimates state and model
error, tells landing and reversal from flags and rates, predicts over a known delay, and moves the FRI inside the sole
to keep the energy of the orbit; a falling phase that begins early is rescaled as a whole, since here it is the ankle
that sees to the speed. `walk(robot, gait, engine="mujoco", errors=..., disturbances=...)` in
`frontal_biped.simulation.walking`.

Feet as light as G1's and iCub's (2e-4 and 3e-3 kg m^2) are moved by torques held for 1 ms across the impact. Error
dynamics of 30 rad/s let both fall; sampled control therefore takes a tenth of the rate, 100 rad/s at 1 kHz.

The whole robot walks here too, on a free base with every joint: `SpaceEngine` in `space_engine`, which
`frontal_biped.simulation.space.walking.walk_in_space` drives.
"""
