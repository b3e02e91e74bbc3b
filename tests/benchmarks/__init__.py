"""What things cost, measured beside their peers in one run. No time is asserted; quote ratios, times are the machine's.

**Designs**, `benchmark_design.py` (extra ``bench``, ``OMP_NUM_THREADS=1``): CPU time of whole designs from the default
start, as a ratio to `optimise_gait` in the same run, one thread:

                                                              reference    pelvis within 5 degrees
    optimise_gait: optimiser, dense check, simulated step       1            1
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

**In space**, 1 kHz, exact sensors, MuJoCo, 16 quiet cores, a process each. `benchmark_space_peer.py`, talos_bent: a
divergent-component law in both planes on the same whole-body program, estimator and plant, tuned by a sweep on
talos_full (steps of 0.50 s, 0.204 m wide, k = 3/s):

                                                ours         peer
    fastest of those tried, 30 steps, m/s       0.6          0.8, the fastest tried
      the next faster one tried                 0.7 falls
    largest push of 10 to 50 N s on the spot, 50 ms
    after a landing, +x, -x, +y, -y, N s        40 50 50 10  50 50 30 20
    half-way through a step                     50 50 40 30  50 50 50 20
    torque squared, (N m)^2, on the spot        15300        17800
    the same per metre at 0.3 m/s               54400        66000
    ground within 5 mm, 20 steps at 0.2 m/s     4 of 4       2 of 4

With its short steps the peer is faster and bears more outwards soon after a landing. Ours needs a seventh less torque,
a sixth less per metre, and walks on uneven ground. (A peer with steps as
long as ours was tried on talos_full before: 0.5 m/s.)

`benchmark_space_ablations.py`, talos_full, 20 steps at 0.2 m/s, the ankle's rate half-way down: 4 % high with all of
it, which holds the rate of the sway; 7 % low with the ankle angle as the phase, 11 % low and falling without the energy
law. On ground within 5 mm talos_bent falls in three of four walks of 20 steps over the ankle angle, after 6 to 15; over
the sway, and without drawing the legs up, none of four falls. Roll joints as outputs change nothing on talos, whose
legs are yaw, roll, pitch. Joint PD in place of the program falls within ten steps.

`benchmark_space_tick.py --robot talos_bent`: a tick takes 0.51 ms in the median, 0.63 to 0.86 ms at 99 %, 1.3 ms at
most on a quiet server core (Python 3.12), 4.2 times bare ProxQP on the same matrices, and a simulated second of the
whole walk 0.79 s. On a slower desk machine (Python 3.11) 0.95 to 1.03 ms, 5.5 times ProxQP, 3.2 to 3.5 times the tick
of TSID 1.10 built from source.
"""
