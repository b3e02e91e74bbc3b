"""Control: the quadratic program of the walking robot and the controllers around it.

`QpController` answers a state with torques at every tick. Nothing but the program's own optimum is called solved.

* *Outputs.* ``outputs="linearising"``: linear error dynamics (``frequency``, ``damping``); ``"clf"``: a rapidly
  exponentially stabilising control Lyapunov function (``epsilon``), relaxed at an exact penalty
  (``frontal-biped simulate G.json --controller clf``).
* *Limits.* Torques, friction cone, unilateral contact, FRI inside the sole; with ``joint_rate`` (off by default) also
  the joints' range and speed, by exponential barriers.
* *No limit active.* The optimum is known in closed form and is taken.
* *A limit active.* In the residuals of its four targets the program is a least-distance problem in four dimensions,
  solved to rounding by SciPy's NNLS, or shown to have no solution.
* *No torques keep every limit.* The limits give way as little as can be, joints rather than contact, motors never, and
  the program is solved with what is left, so torques stay continuous; where the state is not finite or nothing can be
  solved, the last command.
* *Compiled.* ``solver="compiled"`` has the common ticks in one function that Numba compiles (`torques.few_rows`); what
  it does not find goes the way above. Its answers are those of the others to rounding, not to the last digit.
* *ProxQP* takes over where rounding does not let tell; with ``solver="proxqp"`` it is asked at every tick,
  warm-started, tolerance 1e-9, at most 80 iterations. Tests hold the two to each other, 1e-8 with no limit active and
  1e-7 with some.

Commands that do not keep every limit are counted (``controller.relaxed``, ``controller.held``; ``unsolved`` is their
sum), marked (``command.source``) and logged (`logging`, INFO). A test gives the controller 1000 adversarial states:
every solved one passes an independent check of the KKT conditions, every other one is proved infeasible by a linear
program. What a tick costs: `tests/benchmarks/benchmark_control_tick.py`.

*Looking ahead* (stabiliser "adaptive") takes tens of milliseconds a step. A robot looks its answers up:
``save_gait(tabulated(robot, gait), path)`` once, and every walk with the gait of that file takes them from its table.

Rooms: `stabilisers` choose the virtual constraints of each phase, `torques` what the motors do at a tick, `walker`
turns sensor readings into torques as on a robot. `whole_body` and `spatial_walker` do the same for every joint of the
robot free in space.
"""

from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.stabilisers.by_name import STABILISERS, make_stabiliser
from frontal_biped.control.stabilisers.tabulation import tabulated
from frontal_biped.control.stabilisers.transitions import FixedTransitions, ReanchoringTransitions, Stabiliser
from frontal_biped.control.torques.limits import ContactLimits, JointLimits, WalkingLimits
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.torques.torque_program import Source
from frontal_biped.control.torques.walking_qp import WalkingQp

__all__ = [
    "STABILISERS",
    "Command",
    "ContactLimits",
    "ControllerSettings",
    "FixedTransitions",
    "JointLimits",
    "QpController",
    "ReanchoringTransitions",
    "Source",
    "Stabiliser",
    "Targets",
    "WalkingLimits",
    "WalkingQp",
    "make_stabiliser",
    "tabulated",
]
