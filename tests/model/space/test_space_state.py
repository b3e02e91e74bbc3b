"""Virtual legs: what is seen of a free robot from the front, its Jacobians and drifts, and that x is not in it."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_states import DIFFERENCE_TOLERANCE, assert_close, vectors

from frontal_biped.exceptions import RobotError
from frontal_biped.model import FrontalBiped, Stance, load_robot
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import ANGLE, LENGTH, PITCH, ROLL, YAW, SpaceState, X, Y, Z, resting_base

ROBOTS = ("talos_full", "romeo_bent", "g1_bent", "icub_bent", "simple_humanoid_classical")

ROLLING = ("talos_full", "romeo", "romeo_bent", "simple_humanoid_classical", "human", "alexander")
"""Whose roll joints turn about X, so that their angles are the virtual ones."""

BENT = ("talos_full", "romeo_bent", "g1_bent")
"""With knees that take up the length of a step, and axes that are along X to rounding or are not asked to be."""

STEP = 1e-6
"""Of central differences: rounding 1e-16/1e-6, truncation 1e-12."""

EXACT = 1e-10
"""Two ways to the same numbers."""


@pytest.fixture(scope="module", params=ROBOTS)
def space(request) -> SpaceState:
    return SpaceState(FreeRobot(load_robot(request.param).robot))


@pytest.fixture(scope="module", params=BENT)
def bent(request) -> tuple[FrontalBiped, SpaceState]:
    biped = load_robot(request.param)
    return biped, SpaceState(FreeRobot(biped.robot))


def random_states(space, seed, count=4):
    """Anywhere, leaning by 0.2 rad, every joint off its posture and moving: (q, v, heading)."""
    rng, free = np.random.default_rng(seed), space.free
    for _ in range(count):
        shift = np.concatenate([rng.uniform(-1.0, 1.0, 3), rng.uniform(-0.2, 0.2, free.model.nv - 3)])
        q = pin.integrate(free.model, free.posture, shift)
        yield q, rng.uniform(-1.0, 1.0, free.model.nv), float(rng.uniform(-2.0, 2.0))


SWAY = 2e-3
"""Largest distance of the centre of mass in space from the planar one [m]: legs averaged, knees apart forwards."""

SEEN = {
    "pelvis": lambda at: (at.pelvis.angles, at.pelvis.rates, at.pelvis.J, at.pelvis.drift),
    **{
        f"{side.value} {name}": reader
        for side in Stance
        for name, reader in {
            "leg": lambda at, side=side: tuple(getattr(at.legs[side], k) for k in ("values", "rates", "J", "drift")),
            "foot's turning": lambda at, side=side: tuple(
                getattr(at.feet[side].turning, k) for k in ("angles", "rates", "J", "drift")
            ),
            "foot's place": lambda at, side=side: (
                at.feet[side].position, at.feet[side].velocity[:3], at.feet[side].J[:3], at.feet[side].drift[:3],
            ),
            "stance coordinates": lambda at, side=side: tuple(
                getattr(at.frontal(side), k) for k in ("q", "dq", "J", "drift")
            ),
            "sway over a foot at rest": lambda at, side=side: (
                [-side.sign * at.com[Y]], [at.sway(side).rate], at.sway(side).J[None], [at.sway(side).drift],
            ),
        }.items()
    },
}  # fmt: skip
"""Everything that is seen: values, rates, Jacobian, drift."""


@pytest.mark.parametrize("what", SEEN)
def test_jacobians_and_drifts_against_differences(space, what):
    model = space.free.model
    for q, v, heading in random_states(space, 0):
        _, rates, J, drift = (np.array(part) for part in SEEN[what](space.at(q, v, heading)))
        np.testing.assert_allclose(J @ v, rates, atol=EXACT)

        def values(shift, q=q, heading=heading):
            return np.array(SEEN[what](space.at(pin.integrate(model, q, shift), np.zeros(model.nv), heading))[0])

        columns = [(values(STEP * e) - values(-STEP * e)) / (2.0 * STEP) for e in np.eye(model.nv)]
        assert_close(np.transpose(columns), J, DIFFERENCE_TOLERANCE, floor=1.0)

        # a robot that does not accelerate keeps v in the axes of its own root
        def later(t, q=q, v=v, heading=heading):
            return np.array(SEEN[what](space.at(pin.integrate(model, q, v * t), v, heading))[1])

        assert_close((later(STEP) - later(-STEP)) / (2.0 * STEP), drift, DIFFERENCE_TOLERANCE, floor=10.0)


def test_heading_is_where_the_robot_walks(space):
    """Turned about Z with its heading, and the heading frame's origin kept, a robot is seen as before."""
    for q, v, heading in random_states(space, 1):
        before = [np.concatenate([np.ravel(part) for part in SEEN[what](space.at(q, v))[:2]]) for what in SEEN]
        com, com_velocity = space.com.copy(), space.com_velocity.copy()
        turn = pin.utils.rotate("z", heading)
        turned = q.copy()
        turned[:3] = turn @ q[:3]
        turned[3:7] = pin.Quaternion(turn @ pin.Quaternion(q[3:7]).matrix()).coeffs()
        space.at(turned, v, heading)
        for what, expected in zip(SEEN, before, strict=True):
            found = np.concatenate([np.ravel(part) for part in SEEN[what](space)[:2]])
            np.testing.assert_allclose(found, expected, atol=EXACT, err_msg=what)
        np.testing.assert_allclose(space.com, com, atol=EXACT)
        np.testing.assert_allclose(space.com_velocity, com_velocity, atol=EXACT)
        np.testing.assert_allclose(space.to_world(space.com), turn @ com, atol=EXACT)


def test_dynamics_are_those_of_the_model(space):
    """M a + bias is inverse dynamics, and the centre of mass moves as it says."""
    model, data = space.free.model, space.free.model.createData()
    for q, v, heading in random_states(space, 2):
        a = np.linspace(-3.0, 3.0, model.nv)
        at = space.at(q, v, heading)
        assert_close(at.M @ a + at.bias, pin.rnea(model, data, q, v, a), 1e-11)

        def com(t, q=q, v=v, heading=heading):
            return space.at(pin.integrate(model, q, v * t), v, heading).com.copy()

        velocity = at.com_velocity.copy()
        assert_close((com(STEP) - com(-STEP)) / (2.0 * STEP), velocity, DIFFERENCE_TOLERANCE, floor=1.0)


def test_posture_is_upright(space):
    """Nothing leans at the posture; icub's own axes are rounded to 1e-5."""
    at, still = space, np.zeros(space.free.model.nv)
    at.at(space.free.posture, still)
    np.testing.assert_allclose(at.pelvis.angles, 0.0, atol=1e-12)
    for side in Stance:
        np.testing.assert_allclose(at.legs[side].values, [0.0, at.lengths[side]], atol=1e-12)
        np.testing.assert_allclose(at.frontal(side).q, UPRIGHT, atol=1e-4)
        assert abs(at.clearance(side)) < 1e-4


def test_clearance_is_that_of_the_lowest_corner(space):
    free = space.free
    data = free.model.createData()
    for q, v, heading in random_states(space, 3):
        space.at(q, v, heading)
        pin.framesForwardKinematics(free.model, data, q)
        for side, sole in zip((Stance.LEFT, Stance.RIGHT), free.soles, strict=True):
            corners = [data.oMf[free.sole_frame(side)].act(corner) for corner in sole.corners]
            assert space.clearance(side) == pytest.approx(min(corner[Z] for corner in corners), abs=1e-12)


def test_resting_base_leaves_the_foot_where_it_is(space):
    for q, v, heading in random_states(space, 4):
        for stance in Stance:
            still = v.copy()
            still[:BASE] = resting_base(space.at(q, v, heading), stance)
            np.testing.assert_allclose(space.at(q, still, heading).feet[stance].velocity, 0.0, atol=1e-10)


# ---------------------------------------------------------------------- where the roll joints are the virtual angles
@pytest.mark.parametrize("name", ROLLING)
def test_roll_joints_are_the_virtual_angles(name):
    """On a flat foot, whatever the rest of the body looks like, where a leg turns about its roll axes alone."""
    biped = load_robot(name)
    space = SpaceState(FreeRobot(biped.robot))
    free, names = space.free, biped.stance_map.joint_names
    columns = [free.joint_names.index(joint) for joint in names]
    rng = np.random.default_rng(5)
    for stance in Stance:
        for _ in range(5):
            q, v = free.posture.copy(), np.zeros(free.model.nv)
            q[7 + np.array(columns)] += rng.uniform(-0.4, 0.4, 4)
            v[BASE + np.array(columns)] = rng.uniform(-2.0, 2.0, 4)
            q[:7] = on_flat_foot(free, q, stance)
            space.at(q, v)
            v[:BASE] = resting_base(space, stance)
            seen = space.at(q, v).frontal(stance)
            expected = biped.stance_map.positions_to_stance(q[7 + np.array(columns)], stance)
            np.testing.assert_allclose(seen.q, expected, atol=EXACT)
            expected = biped.stance_map.velocities_to_stance(v[BASE + np.array(columns)], stance)
            np.testing.assert_allclose(seen.dq, expected, atol=EXACT)
            np.testing.assert_allclose(
                [space.legs[side].values[LENGTH] for side in Stance], list(space.lengths.values())
            )
            np.testing.assert_allclose([space.legs[side].rates[LENGTH] for side in Stance], 0.0, atol=EXACT)


def on_flat_foot(free, q, stance):
    """(7,) where the root is when a foot lies as at the posture."""
    data = free.model.createData()
    frame = free.sole_frame(stance)
    pin.framesForwardKinematics(free.model, data, free.posture)
    flat = data.oMf[frame].copy()
    pin.framesForwardKinematics(free.model, data, q)
    root = flat * data.oMf[frame].inverse() * data.oMi[1]
    return np.concatenate([root.translation, pin.Quaternion(root.rotation).coeffs()])


# ---------------------------------------------------------------------- x is not in it
def posed(space, stance, wanted, ahead, root_ahead):
    """(nq,) with virtual angles (4,) [rad], pelvis and feet not pitched or yawed, the swing foot ahead in x [m]."""
    free = space.free
    q, still = free.posture.copy(), np.zeros(free.model.nv)
    columns = [*range(BASE), *(BASE + joint for side in Stance for joint in free.leg(side))]
    for _ in range(50):
        at, base = space.at(q, still), pin.Quaternion(q[3:7]).matrix()
        stands, swings, seen = at.feet[stance], at.feet[stance.other], at.frontal(stance)
        moves = np.zeros(free.model.nv)
        moves[:3] = base[X]
        rows = [
            (seen.q - wanted, seen.J),
            (stands.position, stands.J[:3]),
            (stands.turning.angles, stands.turning.J),
            (swings.turning.angles[[PITCH, YAW]], swings.turning.J[[PITCH, YAW]]),
            (at.pelvis.angles[[PITCH, YAW]], at.pelvis.J[[PITCH, YAW]]),
            ([swings.position[X] - ahead], swings.J[[X]]),
            ([q[X] - root_ahead], moves[None]),
            *(([at.legs[side].values[LENGTH] - at.lengths[side]], at.legs[side].J[[LENGTH]]) for side in Stance),
        ]
        error, J = np.concatenate([row[0] for row in rows]), np.vstack([row[1] for row in rows])
        if np.max(np.abs(error)) < 1e-12:
            return q.copy()
        step = np.zeros(free.model.nv)
        step[columns] = -np.linalg.lstsq(J[:, columns], error)[0]
        q = pin.integrate(free.model, q, step)
    raise RobotError("the legs do not reach there")


def places(free, biped, stance, q):
    """(4, 3) stance ankle to swing ankle, hips as points of the pelvis, and (k, 3) joints that the pelvis carries."""
    model, data = free.model, free.model.createData()
    joints = {key: model.getJointId(name) for key, name in biped.description.joints.items()}
    pin.forwardKinematics(model, data, free.posture)
    hips = {side: data.oMi[1].actInv(data.oMi[joints[f"{side.value}_hip"]].translation) for side in Stance}
    pin.forwardKinematics(model, data, q)
    legs = {joints[f"{side.value}_{part}"] for side in Stance for part in ("hip", "ankle")}
    legs |= {k for ankle in list(legs) for k in model.supports[ankle] if k > 1}
    carried = [j for j in range(1, model.njoints) if not legs & set(model.supports[j])]
    ankles = {side: data.oMi[joints[f"{side.value}_ankle"]].translation.copy() for side in Stance}
    other = stance.other
    chain = [ankles[stance], data.oMi[1].act(hips[stance]), data.oMi[1].act(hips[other]), ankles[other]]
    return np.array(chain), np.array([data.oMi[joint].translation for joint in carried])


@given(
    lean=vectors(-0.12, 0.12), ahead=st.floats(-0.08, 0.08), root=st.floats(-0.02, 0.02), stance=st.sampled_from(Stance)
)
def test_places_in_the_plane_do_not_know_how_far_the_feet_are_apart(bent, lean, ahead, root, stance):
    """Hips, ankles, and all that the pelvis carries are where the planar robot has them, to rounding."""
    biped, space = bent
    free = space.free
    frontal = UPRIGHT + lean
    chain = biped.measured.chain(biped.description.sole, stance)
    planar = FrontalBiped(biped.robot, biped.reduction._replace(chain=chain)).joint_positions(frontal)
    _, together = places(free, biped, stance, posed(space, stance, frontal, 0.0, free.posture[X]))
    q = posed(space, stance, frontal, ahead, free.posture[X] + root)
    found, carried = places(free, biped, stance, q)
    np.testing.assert_allclose(-stance.sign * found[:, Y], planar[:, 0], atol=1e-9)
    np.testing.assert_allclose(found[:, Z], planar[:, 1], atol=1e-9)
    assert found[3, X] - found[0, X] == pytest.approx(ahead, abs=1e-9)
    np.testing.assert_allclose(carried[:, Y:], together[:, Y:], atol=1e-9)
    np.testing.assert_allclose(carried[:, X], together[:, X] + root, atol=1e-9)
    # and the pelvis has rolled by what the plane says
    roll = -stance.sign * float(FrontalBiped.pelvis_roll(frontal))
    assert space.at(q, np.zeros(free.model.nv)).pelvis.angles[ROLL] == pytest.approx(roll, abs=1e-9)


@given(lean=vectors(-0.12, 0.12), ahead=st.floats(-0.08, 0.08), stance=st.sampled_from(Stance))
def test_the_sway_is_the_planar_centre_of_mass(bent, lean, ahead, stance):
    """And does not know how far the feet are apart either."""
    biped, space = bent
    free = space.free
    frontal = UPRIGHT + lean
    for apart in (0.0, ahead):
        q = posed(space, stance, frontal, apart, free.posture[X])
        sway = space.at(q, np.zeros(free.model.nv)).sway(stance)
        assert sway.value == pytest.approx(biped.com(frontal)[0], abs=SWAY)
        assert sway.rate == 0.0


@given(lean=vectors(-0.1, 0.1), rates=vectors(-1.0, 1.0), ahead=st.floats(-0.08, 0.08), stance=st.sampled_from(Stance))
def test_velocities_in_the_plane_do_not_either(bent, lean, rates, ahead, stance):
    """With lengths kept and nothing pitching or yawing, the swing ankle has the planar robot's velocity."""
    biped, space = bent
    free = space.free
    frontal = UPRIGHT + lean
    q = posed(space, stance, frontal, ahead, free.posture[X])
    at = space.at(q, np.zeros(free.model.nv))
    stands, swings = at.feet[stance], at.feet[stance.other]
    rows = [at.frontal(stance).J, stands.J, swings.turning.J[[PITCH, YAW]], swings.J[[X]], at.pelvis.J[[PITCH, YAW]]]
    rows += [at.legs[side].J[[LENGTH]] for side in Stance]
    J = np.vstack(rows)
    v = np.linalg.lstsq(J, np.concatenate([rates, np.zeros(len(J) - 4)]))[0]
    at.at(q, v)
    np.testing.assert_allclose(at.frontal(stance).dq, rates, atol=1e-9)
    chain = biped.measured.chain(biped.description.sole, stance)
    plane = FrontalBiped(biped.robot, biped.reduction._replace(chain=chain))
    t = 1e-5
    later, before = (plane.joint_positions(frontal + s * rates) for s in (t, -t))
    planar = (later - before)[-1] / (2.0 * t)
    to_ankle = at.feet[stance.other].rotation @ np.array([0.0, 0.0, biped.ankle_height])
    foot = at.feet[stance.other].velocity
    ankle = foot[:3] + np.cross(foot[3:], to_ankle)
    np.testing.assert_allclose([-stance.sign * ankle[Y], ankle[Z]], planar, atol=1e-7)
    assert abs(ankle[X]) < 1e-9


def test_a_leg_that_grows_is_seen(bent):
    """Off the posture's length the angle is still that of the line from hip to ankle."""
    biped, space = bent
    free = space.free
    side = Stance.LEFT
    q = free.posture.copy()
    data = free.model.createData()
    hip, ankle = (free.model.getJointId(biped.description.joints[f"left_{part}"]) for part in ("hip", "ankle"))
    for joint in free.leg(side):
        q[7 + joint] += 0.05
    pin.forwardKinematics(free.model, data, free.posture)
    # a point of the pelvis: where the hip roll centre was at the posture
    fixed = data.oMi[1].actInv(data.oMi[hip].translation)
    start = data.oMi[ankle].translation - data.oMi[hip].translation
    pin.forwardKinematics(free.model, data, q)
    r = data.oMi[ankle].translation - data.oMi[1].act(fixed)
    angle, length = space.at(q, np.zeros(free.model.nv)).legs[side].values[[ANGLE, LENGTH]]
    assert length == pytest.approx(np.hypot(r[Y], r[Z]), rel=1e-12)
    assert angle == pytest.approx(np.arctan2(r[Y], -r[Z]) - np.arctan2(start[Y], -start[Z]), abs=1e-12)
    assert abs(length - space.lengths[side]) > 1e-4
