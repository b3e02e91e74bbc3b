"""One tick of `SpatialWalker` beside ProxQP's own solve and, where it is installed, beside TSID's tick.

Run from the repository: ``OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_space_tick.py [options]``.

While the robot walks in MuJoCo, each reading is given to `SpatialWalker.tick`, and then the matrices of that tick,
posed once more outside the time, to ProxQP alone (update and solve, warm), so that one run compares them under the same
load. Times are CPU times of the process, which a busy machine inflates but does not interrupt.

TSID solves a problem of its own on the same robot and state: stance foot, centre of mass, swing foot, pelvis, posture,
torque bounds. It is optional. Its wheels corrupt the heap beside Pinocchio 4; it is to be built from source:
pip install --no-binary libtsid,tsid tsid==1.10.0 pin==4.1.0
"""

import argparse
import gc
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from proxsuite import proxqp

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.whole_body.limits import MotionLimits
from frontal_biped.control.whole_body.program import ACCURACY, INNER, ITERATIONS, WholeBodyProgram
from frontal_biped.control.whole_body.targets import WholeBodySolution, WholeBodyTargets
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.quadratic_program import ProxQpSolver, QuadraticProgram
from tests.benchmarks.space_walks import Subject

WARM = 50
"""Ticks that do not count."""


class Contender:
    """A function and the CPU times it took [us]."""

    def __init__(self, call: Callable[..., Any]) -> None:
        self.call, self.times = call, list[float]()

    def __call__(self, *given: Any) -> Any:
        began = time.process_time_ns()
        answer = self.call(*given)
        self.times.append(1e-3 * (time.process_time_ns() - began))
        return answer

    def percentiles(self) -> FloatArray:
        """Median, 99 %, largest."""
        return np.percentile(self.times[WARM:], [50, 99, 100])


class BareProxQp:
    """The solver alone, warm from tick to tick."""

    def __init__(self) -> None:
        self._solver: Any = None
        self.unsolved = 0

    def __call__(self, qp: QuadraticProgram) -> None:
        if self._solver is None:
            adapter = ProxQpSolver(ACCURACY, ITERATIONS, max_inner_iterations=INNER)
            adapter.solve(qp)
            self._solver = adapter._solver
            self._solver.settings.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
        self._solver.update(*qp)
        self._solver.solve()
        self.unsolved += self._solver.results.info.status != proxqp.QPSolverOutput.PROXQP_SOLVED


class Remembering:
    """A whole-body program that remembers what it was asked last."""

    def __init__(self, program: WholeBodyProgram) -> None:
        self._program = program
        self.asked: tuple[SpaceState, WholeBodyTargets] | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._program, name)

    def solve(self, state: SpaceState, targets: WholeBodyTargets) -> WholeBodySolution:
        """As the program."""
        self.asked = state, targets
        return self._program.solve(state, targets)


class TsidTick:
    """TSID's tick on a free robot, its references where the robot is."""

    def __init__(self, free: FreeRobot) -> None:
        import tsid

        self.free, n = free, len(free.joint_names)
        self.robot = tsid.RobotWrapper(free.model, tsid.FLOATING_BASE_SYSTEM, False)
        self.formulation = tsid.InverseDynamicsFormulationAccForce("tick", self.robot, False)
        q, v = free.posture.copy(), np.zeros(free.model.nv)
        self.formulation.computeProblemData(0.0, q, v)
        self.hold: list[object] = []  # TSID crashes when a task it uses is collected
        names = [free.model.frames[frame].name for frame in free.sole_frames]
        sole = free.soles.left
        corners = np.array([[x, y, 0.0] for x in (-sole.back, sole.front) for y in (-sole.outer, sole.inner)]).T
        contact = tsid.Contact6d("stance", self.robot, names[0], corners, np.array([0.0, 0.0, 1.0]), 0.6, 0.0, 1e4)
        contact.setKp(100.0 * np.ones(6))
        contact.setKd(20.0 * np.ones(6))
        contact.setReference(self.robot.framePosition(self.formulation.data(), free.sole_frames[0]))
        self.formulation.addRigidContact(contact, 1e-5, 1e3, 1)
        self.contact = contact
        com = tsid.TaskComEquality("com", self.robot)
        self.swing = tsid.TaskSE3Equality("swing", self.robot, names[1])
        pelvis = tsid.TaskSE3Equality("pelvis", self.robot, free.model.frames[2].name)
        posture = tsid.TaskJointPosture("posture", self.robot)
        for task, size in ((com, 3), (self.swing, 6), (pelvis, 6), (posture, n)):
            task.setKp(100.0 * np.ones(size))
            task.setKd(20.0 * np.ones(size))
        pelvis.setMask(np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))
        data = self.formulation.data()
        for task, weight, reference in (
            (com, 1.0, tsid.TrajectoryEuclidianConstant("com", self.robot.com(data))),
            (
                self.swing,
                1.0,
                tsid.TrajectorySE3Constant("swing", self.robot.framePosition(data, free.sole_frames[1])),
            ),
            (pelvis, 1.0, tsid.TrajectorySE3Constant("pelvis", self.robot.framePosition(data, 2))),
            (posture, 0.1, tsid.TrajectoryEuclidianConstant("posture", q[BASE + 1 :])),
        ):
            task.setReference(reference.computeNext())
            self.formulation.addMotionTask(task, weight, 1, 0.0)
            self.hold += [task, reference]
        bounds = tsid.TaskActuationBounds("torque", self.robot)
        effort = np.minimum(free.limits.effort, 1e4)
        bounds.setBounds(-effort, effort)
        self.formulation.addActuationTask(bounds, 1.0, 0, 0.0)
        self.solver = tsid.SolverHQuadProgFast("solver")
        self.solver.resize(self.formulation.nVar, self.formulation.nEq, self.formulation.nIn)
        self.hold.append(bounds)
        self.failures = 0

    def __call__(self, q: FloatArray, v: FloatArray) -> None:
        problem = self.formulation.computeProblemData(0.0, q, v)
        solution = self.solver.solve(problem)
        if solution.status != 0:
            self.failures += 1
            return
        self.formulation.getActuatorForces(solution)


class Race:
    """A walker whose every tick is timed beside its contenders."""

    def __init__(self, subject: Subject, speed: float) -> None:
        free, walker = subject.free, subject.walker(speed)
        self.walker = walker
        self._remembering = Remembering(walker.program)
        walker.program = self._remembering  # type: ignore[assignment]
        self._posing, self._motion = WholeBodyProgram(free, walker.settings), MotionLimits(free, walker.settings)
        self.bare = BareProxQp()
        self.contenders = {"tick": Contender(walker.tick), "bare ProxQP": Contender(self.bare)}
        self.tsid: TsidTick | None = None
        try:
            self.tsid = TsidTick(free)
            self.contenders["TSID"] = Contender(self.tsid)
        except ImportError:
            print("TSID is not installed; see --help for how to build it")

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """As the walker."""
        self.walker.reset(stance, q, v)

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """As the walker."""
        self.walker.command(speed, lateral, turn)

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """As the walker, and then the others."""
        answer: SpatialCommand = self.contenders["tick"](reading)
        assert self._remembering.asked is not None
        state, targets = self._remembering.asked
        rows = self._posing.rows.write(state, targets)
        self.contenders["bare ProxQP"](self._posing.pose(rows, state, targets.stance, self._motion.at(state)))
        if self.tsid is not None and targets.stance is Stance.LEFT:
            self.contenders["TSID"](state.q, state.v)
        return answer


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="talos_full")
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.0, 0.27])
    chosen = parser.parse_args()
    subject = Subject(chosen.robot)
    subject.walk(subject.walker(), 1)  # imports and first calls are not the tick's
    print(f"{chosen.robot}, Pinocchio {pin.__version__}; CPU time in us: median, 99 %, largest")
    for speed in chosen.speeds:
        race = Race(subject, speed)
        gc.disable()
        run = subject.walk(race, chosen.steps)
        gc.enable()
        counts = {name: count for name, count in race.walker.program.counts.items() if count}
        print(
            f"{speed:.2f} m/s, {run.steps_completed} steps ({run.outcome}), {len(race.contenders['tick'].times)} ticks"
        )
        print(f"  answers {counts}; ProxQP without an answer {race.bare.unsolved}")
        ours = race.contenders["tick"].percentiles()
        for name, contender in race.contenders.items():
            theirs = contender.percentiles()
            of = "" if name == "tick" else "   tick over this {:.2f}, {:.2f}".format(*(ours / theirs)[:2])
            print(f"  {name:12}" + " ".join(f"{value:7.0f}" for value in theirs) + of, flush=True)
        if race.tsid is not None:
            print(f"  TSID without an answer {race.tsid.failures}")
        began = time.process_time()
        run = subject.walk(subject.walker(speed), chosen.steps)
        seconds = time.process_time() - began
        print(
            f"  a simulated second of the whole walk, MuJoCo, records and collision search: {seconds / run.t[-1]:.2f} s"
        )


if __name__ == "__main__":
    main()
