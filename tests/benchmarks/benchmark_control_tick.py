"""One control tick beside ProxQP's own solve and, where it is installed, beside TSID's tick on the same robot.

python tests/benchmarks/benchmark_control_tick.py [--ticks N]

Every state is given to each contender in turn, so that one run compares them under the same load; times are CPU times
of the thread, which a busy machine inflates but does not interrupt. "bare ProxQP" is update() and solve() of the
walking program alone, kept warm from tick to tick, without a line of the package around it.

Last, the slowest ticks of the states that are anywhere, over a walking tick. A single time may be an interruption's:
each of the `SLOWEST` is asked for again, `REPEATS` times, and its least time counts; walking ticks likewise.

Numba is optional: with it solver "compiled" is measured too, in the same loop.

TSID 1.10.0 is optional. Its wheels corrupt the heap beside Pinocchio 4; built from source it works:
pip install --no-binary libtsid,tsid tsid==1.10.0 pin==4.1.0      (about 7 minutes)
"""

import argparse
import gc
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pinocchio as pin
from proxsuite import proxqp

import frontal_biped as fb
from frontal_biped.control import ControllerSettings, QpController, Source
from frontal_biped.control.torques.torque_program import PENALTY_PARAMETER
from frontal_biped.design import optimise_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.model import FrontalBiped, Stance
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import ProxQpSolver, QuadraticProgram
from frontal_biped.virtual_constraints import StepPhase

PERIOD = 1e-3  # [s]
FREQUENCY = 100.0  # [rad/s] of the error dynamics, what 1 kHz takes by default
SLOWEST, REPEATS = 40, 30


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=4000)
    ticks = parser.parse_args().ticks
    robot = fb.load_robot()
    gait = optimise_gait(robot).gait
    assert gait is not None
    settings = replace(ControllerSettings.for_gait(gait), frequency=FREQUENCY)
    tight = replace(settings, max_torque=(8.0, 45.0, 45.0, 8.0))
    walk = list(walking_states(robot, gait, ticks))
    cases = {
        "walking": (walk, settings),
        "walking, clf": (walk, replace(settings, outputs="clf")),
        "walking, joint limits too": (walk, replace(settings, joint_rate=FREQUENCY)),
        "1 mrad off": (list(noisy(walk, 1e-3)), settings),
        "10 mrad off": (list(noisy(walk, 1e-2)), settings),
        "weak motors, 1 mrad off": (list(noisy(walk, 1e-3)), tight),
        "anywhere": (list(scattered(gait, ticks)), replace(settings, joint_rate=FREQUENCY)),
    }
    print(f"CPU time in us: p50 / p99 / max of {ticks} ticks at 1 kHz")
    gc.disable()
    for name, (states, chosen) in cases.items():
        report(name, compare(robot, gait, states, chosen))
    report_slowest(robot, gait, cases["walking"], cases["anywhere"])
    gc.enable()


# ---------------------------------------------------------------------- states
Asked = tuple[StepPhase, np.ndarray, np.ndarray]
"""What a tick is given: phase, q, dq."""


def walking_states(robot: FrontalBiped, gait: Gait, count: int) -> Iterator[Asked]:
    """The states of a sampled walk, tick after tick."""
    steps = int(np.ceil(count * PERIOD / gait.orbit.step_duration)) + 1
    settings = fb.simulation.SimulationSettings(record_rate=1.0 / PERIOD)
    run = fb.simulate(robot, gait, steps=steps, period=PERIOD, stabiliser="adaptive", simulation_settings=settings)
    for rising, q, dq in list(zip(run.phase > 0, run.q, run.dq, strict=True))[:count]:
        yield (StepPhase.RISING if rising else StepPhase.FALLING), q, dq


def noisy(states: list[Asked], size: float) -> Iterator[Asked]:
    """The same with noise of the given size in position [rad], five times as much in speed [rad/s]."""
    rng = np.random.default_rng(0)
    for phase, q, dq in states:
        yield phase, q + size * rng.normal(size=4), dq + 5.0 * size * rng.normal(size=4)


def scattered(gait: Gait, count: int) -> Iterator[Asked]:
    """States up to a radian off the virtual constraints, slow and fast; many admit no torques at all."""
    rng = np.random.default_rng(5)
    for _ in range(count):
        which = StepPhase.RISING if rng.integers(2) else StepPhase.FALLING
        phase = gait.rising if which is StepPhase.RISING else gait.falling
        size = 10.0 ** rng.uniform(-3.0, 0.0)
        beta = phase.beta_start + rng.uniform(-0.1, 1.1) * phase.range
        h_d, h_d1, *_ = phase.desired(beta)
        rate = 2.0 * size * rng.normal()
        yield (
            which,
            np.r_[beta, h_d + size * rng.normal(size=3)],
            np.r_[rate, h_d1 * rate + 10.0 * size * rng.normal(size=3)],
        )


# ---------------------------------------------------------------------- contenders
class Contender:
    """A function of a state, or of the program posed there, and the times it took."""

    def __init__(self, call: Callable[..., object]) -> None:
        self.call, self.times = call, []

    def __call__(self, *given) -> None:
        began = time.thread_time_ns()
        self.call(*given)
        self.times.append(1e-3 * (time.thread_time_ns() - began))

    def __str__(self) -> str:
        return " / ".join(f"{t:5.0f}" for t in np.percentile(self.times, [50, 99, 100]))


class BareProxQp:
    """The solver alone on the program of a controller: posing it is not part of the time."""

    def __init__(self, controller: QpController) -> None:
        self.controller, self.solver = controller, None

    def posed(self, phase: StepPhase, q: np.ndarray, dq: np.ndarray) -> QuadraticProgram:
        """The program to solve."""
        state = State(q, dq)
        return self.controller.program.pose(state, self.controller.targets(phase, state)[0]).program

    def __call__(self, program: QuadraticProgram) -> None:
        if self.solver is None:
            settings = self.controller.settings
            adapter = ProxQpSolver(settings.accuracy, settings.max_iterations, penalty_parameter=PENALTY_PARAMETER)
            adapter.solve(program)
            self.solver = adapter._solver
            self.solver.settings.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
        self.solver.update(*program)
        self.solver.solve()


class TsidTick:
    """TSID on the same URDF, free-floating: stance contact, centre of mass, posture, torque bounds."""

    def __init__(self, robot: FrontalBiped) -> None:
        import tsid

        model = pin.buildModelFromUrdf(str(robot.path.parent / robot.description.urdf), pin.JointModelFreeFlyer())
        self.map, data = robot.stance_map, model.createData()
        self.columns = [model.joints[model.getJointId(name)] for name in self.map.joint_names]
        self.foot = model.getFrameId(model.frames[model.getFrameId(self.map.joint_names[0])].name)
        self.model, self.data = model, data
        self.robot = tsid.RobotWrapper(model, tsid.FLOATING_BASE_SYSTEM, False)
        self.hold: list[object] = []  # TSID crashes when a task it uses is collected
        q, v = pin.neutral(model), np.zeros(model.nv)
        self.formulation = tsid.InverseDynamicsFormulationAccForce("tick", self.robot, False)
        self.formulation.computeProblemData(0.0, q, v)
        outer, inner = robot.sole
        corners = np.array([[x, y, -robot.ankle_height] for x in (-0.1, 0.1) for y in (outer, inner)]).T
        foot = model.frames[self.foot].name
        contact = tsid.Contact6d("stance", self.robot, foot, corners, np.array([0.0, 0.0, 1.0]), 0.6, 0.0, 1e4)
        contact.setKp(100.0 * np.ones(6))
        contact.setKd(20.0 * np.ones(6))
        contact.setReference(self.robot.framePosition(self.formulation.data(), self.foot))
        # the foot's rest as a heavy cost: as a constraint its quadratic program does not come back on this robot
        self.formulation.addRigidContact(contact, 1e-5, 1e3, 1)
        com = tsid.TaskComEquality("com", self.robot)
        com.setKp(100.0 * np.ones(3))
        com.setKd(20.0 * np.ones(3))
        self.formulation.addMotionTask(com, 1.0, 1, 0.0)
        posture = tsid.TaskJointPosture("posture", self.robot)
        posture.setKp(FREQUENCY**2 * np.ones(4))
        posture.setKd(2.0 * FREQUENCY * np.ones(4))
        self.formulation.addMotionTask(posture, 1e-1, 1, 0.0)
        bounds = tsid.TaskActuationBounds("torque", self.robot)
        bounds.setBounds(-model.effortLimit[-4:], model.effortLimit[-4:])
        self.formulation.addActuationTask(bounds, 1.0, 0, 0.0)
        com_reference = tsid.TrajectoryEuclidianConstant("com", self.robot.com(self.formulation.data()))
        com.setReference(com_reference.computeNext())
        self.sample = tsid.TrajectorySample(4)
        self.posture = posture
        self.solver = tsid.SolverHQuadProgFast("solver")
        self.solver.resize(self.formulation.nVar, self.formulation.nEq, self.formulation.nIn)
        self.hold += [contact, com, bounds, com_reference]
        self.failures = 0

    def free_flyer(self, q: np.ndarray, dq: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Configuration and velocity of the floating robot whose stance foot rests: not part of the tick."""
        angles = self.map.positions_to_urdf(q, Stance.LEFT)
        rates = self.map.velocities_to_urdf(dq, Stance.LEFT)
        full, speed = pin.neutral(self.model), np.zeros(self.model.nv)
        for joint, angle, rate in zip(self.columns, angles, rates, strict=True):
            full[joint.idx_q], speed[joint.idx_v] = angle, rate
        pin.forwardKinematics(self.model, self.data, full)
        pin.updateFramePlacements(self.model, self.data)
        full[:7] = pin.SE3ToXYZQUAT(self.data.oMf[self.foot].inverse())
        pin.computeJointJacobians(self.model, self.data, full)
        J = pin.getFrameJacobian(self.model, self.data, self.foot, pin.LOCAL)
        speed[:6] = np.linalg.solve(J[:, :6], -J[:, 6:] @ speed[6:])
        return full, speed

    def __call__(self, phase: StepPhase, q: np.ndarray, dq: np.ndarray) -> None:
        self.sample.value(q[7:])
        self.posture.setReference(self.sample)
        problem = self.formulation.computeProblemData(0.0, q, dq)
        solution = self.solver.solve(problem)
        if solution.status != 0:
            self.failures += 1
            return
        self.formulation.getActuatorForces(solution)


def tsid_tick(robot: FrontalBiped) -> TsidTick | None:
    """TSID's tick, or None with a word on why not."""
    try:
        return TsidTick(robot)
    except ImportError:
        print("TSID is not installed; see --help for how to build it")
        return None


# ---------------------------------------------------------------------- comparison
def compare(robot: FrontalBiped, gait: Gait, states: list[Asked], settings: ControllerSettings):
    ours, always = (QpController(robot, gait, replace(settings, solver=solver)) for solver in ("exact", "proxqp"))
    ticks = {"tick": Contender(ours.command), "tick, ProxQP every time": Contender(always.command)}
    if find_spec("numba"):
        ticks["tick, compiled"] = Contender(QpController(robot, gait, replace(settings, solver="compiled")).command)
    solver = BareProxQp(always)
    bare = Contender(solver)
    peers = {**ticks, "bare ProxQP": bare}
    tsid = tsid_tick(robot)
    theirs = None if tsid is None else Contender(tsid)
    for i, (phase, q, dq) in enumerate(states):
        for peer in ticks.values():
            peer(phase, q, dq)
        bare(solver.posed(phase, q, dq))
        if tsid is not None and theirs is not None:
            theirs(phase, *tsid.free_flyer(q, dq))
        if i == 20:  # warm
            for peer in (*peers.values(), *([theirs] if theirs else [])):
                peer.times.clear()
    if theirs is not None:
        peers["TSID"] = theirs
    return ours, peers, None if tsid is None else tsid.failures


def report(name: str, compared) -> None:
    ours, peers, failures = compared
    counts = ", ".join(f"{ours.counts[source]} {source.value}" for source in Source if ours.counts[source])
    print(f"\n{name}: {counts}" + (f"; TSID without an answer {failures}" if failures is not None else ""))
    assert sum(ours.counts.values()) == ours.ticks
    tick, bare = peers["tick"], peers["bare ProxQP"]
    for label, peer in peers.items():
        ratio = np.percentile(tick.times, [50, 99]) / np.percentile(peer.times, [50, 99])
        of = "" if peer is tick else f"   our tick over this: p50 {ratio[0]:.2f}, p99 {ratio[1]:.2f}"
        print(f"  {label:24} {peer}{of}")
    always = peers["tick, ProxQP every time"]
    share = np.percentile(always.times, [50, 99]) / np.percentile(bare.times, [50, 99])
    print(f"  {'ProxQP every time / bare':24} p50 {share[0]:.2f}, p99 {share[1]:.2f}")


def report_slowest(robot: FrontalBiped, gait: Gait, walking, anywhere) -> None:
    """The slowest tick of states that may be anywhere, over the median tick of a walk."""
    print(f"\nslowest of {len(anywhere[0])} ticks anywhere over a walking tick, least of {REPEATS}:")
    for solver in ("exact", "compiled") if find_spec("numba") else ("exact",):
        usual, unusual = (
            QpController(robot, gait, replace(settings, solver=solver)) for _, settings in (walking, anywhere)
        )
        tick = np.median([least_time(usual, asked) for asked in walking[0][:: len(walking[0]) // SLOWEST]])
        once = [least_time(unusual, asked, 1) for asked in anywhere[0]]
        slowest = max(least_time(unusual, anywhere[0][i]) for i in np.argsort(once)[-SLOWEST:])
        print(f"  {solver:24} {slowest:5.0f} / {tick:5.0f} = {slowest / tick:.1f}")


def least_time(controller: QpController, asked: Asked, repeats: int = REPEATS) -> float:
    """The least time of a state [us]."""
    tick = Contender(controller.command)
    for _ in range(repeats):
        tick(*asked)
    return min(tick.times)


if __name__ == "__main__":
    main()
