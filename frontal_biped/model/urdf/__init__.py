"""From a URDF to the bodies of the frontal plane: read, describe, find legs and soles, lock, project, symmetrise.

Any URDF with two legs whose hips and ankles roll. `proposal` finds the legs by axis, side and order of their joints, a
posture, and the soles on the feet's shapes, and says what it could not decide; `description` is the file that says it.
What the readers of URDFs disagree about is put right before any of them sees the text (`normal_form`), and inertias are
compared with the text's afterwards (`inertia_check`).

Every joint but the four is locked at the posture, and mass, (y, z) of the centre of mass and moment about X of each
body are taken over: nothing else enters a motion in the plane. Roll axes must be along X to 1e-3 rad, feet flat. Where
the hip roll joint hangs below the hip pitch joint, that holds at one hip pitch only: `posture` finds it, with the
centre of mass over the soles (``frontal-biped robots --posture my_biped.toml`` prints the description). Robots that
break one of the paper's hypotheses HR1 to HR5 (chain, planar axes, mirrored legs, four actuated joints, feet) are
refused with the hypothesis and the remedy. URDF limits of torque, angle and speed bind the design.
"""
