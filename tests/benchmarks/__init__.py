"""What things cost, measured beside their peers in one run. No time is asserted; quote ratios, times are the machine's.

**Designs**, `benchmark_design.py --quick` (extra ``bench``, ``OMP_NUM_THREADS=1``): CPU time of whole designs from the
default start, as a ratio to `optimise_gait` in the same run, one thread; medians of three runs with nothing beside
them:

                                                              reference    pelvis within 5 degrees
    optimise_gait: optimiser, dense check, simulated step       1            1
    the same problem in CasADi with IPOPT, exact Hessian     22.5         18.8
      of which IPOPT, its derivative graphs already built     4.8          3.0, from 2.3 to 3.0
    optimiser alone                                           0.59         0.60
    SciPy SLSQP, our exact gradients                          6.0          3.3

All of these reach the optimum. Of SciPy trust-constr and IPOPT without second derivatives, 60 s each on our gradients,
only the latter did, and on the second specification alone, when that was last tried. Beside the package of commit
6097817, in turn on a quiet machine, least of forty bursts: an evaluation with all derivatives takes 0.90 to 0.93 ms
where it took 2.67 to 2.87. A design took 2.7 and 2.9 times less CPU time when that was 1.2 ms, a gait of a library (25
neighbours) 2.7 times: 87 ms where it took 238.
`benchmark_starts.py` says how often random starts and random specifications succeed.

**Ticks**, `benchmark_control_tick.py`: one tick at 1 kHz on the Table I robot beside TSID 1.10, built from source, in
one loop; medians over 4000 ticks, as a ratio to TSID's, which is C++ and solves another problem (free-floating, 22
variables):

                                                default     solver "compiled" (Numba)
    walking, no limit active                    0.57        0.60
    1 mrad off                                  0.58        0.57
    10 mrad off, 92 % of ticks at a limit       0.97        0.57
    weak motors, 73 % of ticks at a limit       1.02        0.58

Of 4000 states up to a radian off the gait, the slowest tick (the least of 30, of each of the 40 slowest) took 9.0
and 9.2 walking ticks by default and 7.7 and 8.1 by solver "compiled" on a quiet machine; on a busy one 8.5 to 12.

**Looking ahead** (stabiliser ``adaptive``), `benchmark_look_ahead.py`, ms on a busy machine, 1000 speeds over the
basin:

                                                reference        level            g1
    looked up at the impact: 99 %, most         0.27, 0.62       0.34, 0.59       0.26, 0.41
    looked up at the reversal: 99 %, most       0.73, 0.99       0.74, 1.00       0.65, 0.84
    computed at the impact: median, 99 %        42, 93           26, 64           33, 71
    to make the table, CPU s                    91               66               118

Every answer is the computed one. Landings off the planned pose are answered as for the planned one.

**Simulated time**, `benchmark_simulation.py --against TREE`, ms of CPU a simulated second, Table I robot, 8 steps,
before (6097817) and now in turn on a quiet machine:

    continuous, rtol 1e-8, phases fixed          85          13
    1 kHz, the controller told the state        137          54
    1 kHz, the walker                           264         107
    the walker in MuJoCo                        280         119

The first is a periodic walk: from its second step on a phase is followed from that of the step before (23.3 without).

**What a user waits for**, `benchmark_waiting.py` or the command itself, processor time of all processes, before and
now in turn: a GIF of 16 s of continuous walking takes 13 s where it took 140 (fewer and smaller pictures are part of
that; the steps of that walk take a whole number of pictures); installed from the clone, the robustness card takes 8.2,
8.7 and 9.2 s where it took 48.5, 51.5 and 47.5, the demonstration 9.3 and 10.2 s where it took 30.9 and 33.2, by the
clock 5.8 and 6.0 s where it took 18.9 and 19.2 (medians of twice nine pairs on two cores; of the ratios 0.32 and 0.31
both ways, single pairs 0.22 to 0.40).

**The studio**, `benchmark_studio.py`: from a slider to a new gait 0.19 s of processor time where it took 0.34, medians
of 20 changes in turn on a busy machine; 0.7 s at most.

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
