"""What things cost, measured beside their peers in one run. No time is asserted; quote ratios, times are the machine's.

**Designs**, `benchmark_design.py` (extra ``bench``, ``OMP_NUM_THREADS=1``): CPU time of whole designs from the default
start, as a ratio to `design_gait` in the same run, one thread:

                                                              reference    pelvis within 5 degrees
    design_gait: optimiser, dense check, simulated step       1            1
    the same problem in CasADi with IPOPT, exact Hessian      4.9          3.8
      of which IPOPT, its derivative graphs already built     1.2          0.7
    optimiser alone                                           0.57         0.77
    SciPy SLSQP, our exact gradients                          2.6          1.5
    SciPy SLSQP, finite differences                           33           15

All of these reach the optimum. Of SciPy trust-constr and IPOPT without second derivatives, 60 s each on our gradients,
only the latter does, and on the second specification alone. For many designs of one shape, IPOPT with its graph kept is
about as fast as we are. `benchmark_starts.py` says how often random starts and random specifications succeed.

**Ticks**, `benchmark_control_tick.py`: one tick at 1 kHz on the Table I robot, CPU time over what ran beside it in the
same loop, median and 99 %:

                                                over bare ProxQP,    over TSID 1.10,
                                                update + solve       same robot
    walking, no limit active                    1.7, 2.1             0.76, 0.86
    with the control Lyapunov function          1.4, 1.3             0.91, 0.96
    10 mrad off, 92 % of ticks with a limit     1.7, 0.2             1.8, 1.7

TSID solves another problem (free-floating, 22 variables) in C++. Its tick does not grow when a limit binds; ours does.
Of 4000 states up to a radian off the gait, 16 % without a solution, the slowest tick took 15 times a walking one.

**Looking ahead** (stabiliser ``adaptive``) takes 0.1 to 0.4 s of one core at an impact more than 0.3 % off the gait's
speed: simulated time waits for it, a robot would need a table of its answers.

**The studio**, `benchmark_studio.py`: from a slider to a new gait 0.31 s, median of 20 changes, 1.5 s at most.

**Humanoids**, `benchmark_humanoids.py`, from URDF to certified gait: 4.5 to 13.2 CPU s on a busy machine with
0.2.0, 1.4 to 5.5 on a quiet one with 0.1.0.

`benchmark_library.py` has the rate of a library on one and two processes, `benchmark_mujoco.py` what MuJoCo makes of
the gaits.

**In space**, talos, 1 kHz, exact sensors, MuJoCo. `benchmark_space_peer.py`: a divergent-component law in both planes
on the same whole-body program, estimator and plant, tuned by a sweep (steps of 0.50 s, 0.204 m wide, k = 3/s):

                                                ours         peer         peer, 0.73 s
    fastest of those tried, 30 steps, m/s       0.4          0.8          0.5
      the next faster one tried                 0.5          1.0          0.7
    largest push of 10, 20, 30, 40 N s on the spot
    after a landing, +x, -x, +y, -y, N s        30 30 20 10  40 40 30 20
    half-way through a step                     40 40 40 30  40 40 40 20
    torque squared, (N m)^2, on the spot        15100        17900        18400
    the same per metre at 0.3 m/s               57500        66300        64500

With its own short steps the peer walks twice as fast and bears more soon after a landing; with our step duration the
difference in speed is small. Ours bears more outwards half-way, and takes a seventh less torque.

`benchmark_space_ablations.py`, 20 steps: without learning from step to step the frontal speed half-way down is 4 to 6 %
low instead of 0.5 %, without the energy law it drifts to half; joint PD in place of the program falls within 8 steps.
The roll joints as outputs change little on talos, whose legs are yaw, roll, pitch; with a phase read from the stance
ankle's joint as well, against a foot that tilts by some 0.3 mrad in soft contact, it falls within 11 steps.

`benchmark_space_tick.py`, on a busy machine: a tick is 3.2 to 3.7 times bare ProxQP on the same matrices in the median,
1.2 times at 99 %; TSID was not built.
"""
