"""Every infeasible or malformed scenario: one line with file, field and remedy, and exit status 2."""

import re

import pytest

from frontal_biped.cli import main

MALFORMED = {
    "unknown key": ("stepz = 3", "unknown key 'stepz'.*did you mean 'steps'"),
    "unknown section": ("[expectations]\nsteps = 3", "unknown key 'expectations'.*did you mean"),
    "no TOML": ("steps = = 3", "not valid TOML.*line 1"),
    "steps of the wrong type": ('steps = "many"', "steps = 'many'.*whole number.*write"),
    "no steps": ("steps = 0", "steps = 0.*at least|steps = 0.*from 1"),
    "a seed below zero": ("seed = -1", "seed = -1.*whole number"),
    "a flag that is none": ("slow = 1", "slow = 1.*true nor false"),
    "an unknown simulator": ('simulator = "gazebo"', "simulator = 'gazebo'.*ours, mujoco"),
    "an unknown robot": ('robot = "frontal_bipet"', "robot = 'frontal_bipet'.*did you mean 'frontal_biped'"),
    "a robot file that is not there": ('robot = "my.toml"', "robot = .*my.toml.*no such file"),
    "an unknown specification": ('gait = "robustt"', "gait = robustt.*did you mean 'robust'"),
    "a gait file that is not there": ('gait = "my.gait.json"', r"gait = .*my\.gait\.json.*no such"),
    "a specification with a bad key": ("[gait]\nfrictoin = 0.5", "gait = .*frictoin.*did you mean 'friction'"),
    "a specification that no gait meets": ("[gait]\nstep_width = [3.0, 3.1]", "gait = .*step_width.*(reach|apart|3)"),
    "an unknown controller": ('controller = "pid"', r"\[controller\] type = 'pid'.*walker, qp.*module:factory"),
    "an unknown stabiliser": ('[controller]\nstabiliser = "magic"', r"\[controller\] stabiliser = 'magic'.*adaptive"),
    "a gain of the wrong type": ('[controller]\nfrequency = "high"', r"\[controller\] frequency = 'high'.*number"),
    "a gain below zero": ("[controller]\ndamping = -1.0", r"\[controller\] damping = -1.0.*below 0"),
    "a controller key nobody knows": ("[controller]\ngain = 1.0", r"\[controller\]: unknown key 'gain'"),
    "a period of a minute": ("[controller]\nperiod = 60.0", r"\[controller\] period = 60.0.*above 0.02 s"),
    "arguments for a packaged controller": ("[controller]\narguments = {k = 1}", r"arguments = .*your own factory"),
    "a module that is not there": (
        'controller = "no_such_module:make"',
        "no_such_module.*put no_such_module.py beside",
    ),
    "a factory that is not there": ('controller = "math:make_walker"', "'math' has no 'make_walker'"),
    "a factory that makes no controller": (
        'controller = "math:hypot"',
        "math:hypot.*(refused|is no controller)",
    ),
    "qp in MuJoCo": ('simulator = "mujoco"\ncontroller = "qp"', 'controller = "qp" is told.*"walker"'),
    "an unknown link": ("[model]\nmass = {torso = 1.1}", r"\[model\] mass.*unknown key 'torso'.*pelvis"),
    "a weightless link": ("[model]\nmass = {pelvis = 0.0}", r"\[model\] mass pelvis = 0.0.*below 0.05"),
    "a shift with one number": ("[model]\ncom = {pelvis = [0.01]}", r"\[model\] com pelvis = .*not a list of 2"),
    "a draw beyond everything": ("[model]\nmass = {within = 1.5}", r"\[model\] mass within = 1.5.*above 0.9"),
    "a section that is no table": ('disturbances = "all"', r"\[disturbances\] = 'all' is not a table"),
    "negative noise": ("[disturbances]\nencoder_noise = -0.1", r"\[disturbances\] encoder_noise = -0.1.*below 0 rad"),
    "a range upside down": (
        "[disturbances]\nfriction = {from = 0.9, to = 0.3}",
        r"\[disturbances\] friction = .*exchange them",
    ),
    "half a range": ("[disturbances]\nfriction = {from = 0.9}", r"\[disturbances\] friction = .*write {from"),
    "friction around zero": ("[disturbances]\nfriction = {within = 0.3}", r"\[disturbances\] friction = .*write {from"),
    "not a number": ("[disturbances]\ndelay = nan", r"\[disturbances\] delay = nan.*finite number"),
    "one torque limit": ("[disturbances]\ntorque_limits = [50.0]", r"torque_limits = .*list of 2 numbers in N m"),
    "more ground than steps": ("steps = 1\n[disturbances]\nground = [0.0, 0.0]", "ground has 2 heights for 1 step"),
    "a push without an impulse": ('[[push]]\nat = "impact of step 1"', r"\[\[push\]\] 1: impulse: missing"),
    "a push at no time": ("[[push]]\nimpulse = 1.0", r"\[\[push\]\] 1: at: missing; write either"),
    "a push at two times": ('[[push]]\nat = "impact of step 1"\ntime = 1.0\nimpulse = 1.0', "at = .*given beside time"),
    "a push nobody understands": ('[[push]]\nat = "noon"\nimpulse = 1.0', "at = 'noon'.*not understood.*reversal of"),
    "a push at step 0": ('[[push]]\nat = "impact of step 0"\nimpulse = 1.0', "at = .*steps from 1"),
    "a push after a phase": (
        '[[push]]\nat = "130 % of the rising phase of step 1"\nimpulse = 1.0',
        "at = .*more than 100 %",
    ),
    "a push after the last step": (
        'steps = 2\n[[push]]\nat = "impact of step 9"\nimpulse = 1.0',
        "step 9.*raise steps",
    ),
    "a push after the end": ("steps = 2\n[[push]]\ntime = 99.0\nimpulse = 1.0", "time = 99 s.*ends at"),
    "a push that lasts no time": (
        "[[push]]\ntime = 0.1\nimpulse = 1.0\nduration = 0.0",
        r"duration = 0.0.*below 0.0001 s",
    ),
    "an unknown profile": ('[[push]]\ntime = 0.1\nimpulse = 1.0\nprofile = "sine"', "profile = 'sine'.*half-sine"),
    "an unknown expectation": ("[expect]\noutput_eror = 0.1", r"\[expect\]: unknown key 'output_eror'.*output_error"),
    "an expectation that cannot be": (
        "steps = 3\n[expect]\nreturn_within = 5",
        "return_within = 5: the walk has 3",
    ),
    "tolerance for nothing": ("[expect]\nreturn_tolerance = 0.1", "return_tolerance without return_within"),
    "a survival of 120 %": ("[expect]\nsurvival = 1.2", r"\[expect\] survival = 1.2.*above 1"),
    "durations upside down": ("[expect]\nstep_duration = [0.8, 0.4]", "step_duration = .*exchange them"),
    "slip in the rigid simulator": ("[expect]\nfoot_slip = 0.01", "foot_slip = 0.01.*foot rests.*mujoco"),
    "the same trial ten times": ("repeat = 10", "repeat = 10.*nothing in the scenario is random"),
    "a name that is no file's": ('name = "../push"', "name = '../push'.*letters"),
}

MALFORMED |= {
    f"in space, {case}": ('space = true\nrobot = "talos_full"\n' + text, complaint)
    for case, (text, complaint) in {
        "our simulator": ('simulator = "ours"', "simulator = 'ours'.*only MuJoCo"),
        "a controller that is told": ('controller = "qp"', 'controller = "qp" is told.*"walker"'),
        "a stabiliser": (
            '[controller]\nstabiliser = "ankle"',
            r"\[controller\] stabiliser: of walks in the plane",
        ),
        "a gain of the plane": ("[controller]\nfrequency = 90.0", r"\[controller\]: unknown key 'frequency'"),
        "a gain below zero": ("[controller]\noutput = -1.0", r"\[controller\] output = -1.0.*below 0"),
        "flat landings": ("flat_landing = 0.1", "flat_landing = 0.1.*MuJoCo has its own contact"),
        "a speed beyond everything": ("speed = 30.0", "speed = 30.0.*above 3 m/s"),
        "a command at no time": ("[[command]]\nspeed = 0.1", r"\[\[command\]\] 1: step: missing; write either"),
        "a command at two": ("[[command]]\nspeed = 0.1\nstep = 1\ntime = 0.1", "step = 1: given beside time"),
        "a command of nothing": ("[[command]]\nstep = 2", "speed: missing; write speed"),
        "a command at step 0": ("[[command]]\nstep = 0\nspeed = 0.1", "step = 0.*at least 1"),
        "a command after the end": ("steps = 2\n[[command]]\nstep = 3\nspeed = 0.1", "step = 3: the walk has 2 steps"),
        "commands that are none": ("command = 3", "command = 3.*begin each command with"),
        "a push of one number": (
            "[[push]]\ntime = 0.1\nimpulse = 3.0",
            "impulse = 3.0: not three.*direction",
        ),
        "a push of two": ("[[push]]\ntime = 0.1\nimpulse = [3.0, 1.0]", "impulse = .*not three components"),
        "a push of words": ('[[push]]\ntime = 0.1\nimpulse = [1.0, "up", 0.0]', "left = 'up'.*finite number"),
        "components with a direction": (
            "[[push]]\ntime = 0.1\nimpulse = [3.0, 1.0, 0.0]\ndirection = 90",
            "impulse = .*leave direction out",
        ),
        "a push on no link": (
            '[[push]]\ntime = 0.1\nimpulse = [3.0, 1.0, 0.0]\nlink = "torso"',
            r"\[\[push\]\] 1: push: link = 'torso': talos_full has no such link",
        ),
        "a push at the hips": ("[[push]]\ntime = 0.1\nimpulse = [3.0, 1.0, 0.0]\nheight = 0.1", "unknown key 'height'"),
        "a push after the last step": (
            'steps = 2\n[[push]]\nat = "impact of step 9"\nimpulse = [1.0, 0.0, 0.0]',
            "step 9.*raise steps",
        ),
        "a push after the end": ("steps = 2\n[[push]]\ntime = 99.0\nimpulse = [1.0, 0.0, 0.0]", "time = 99 s.*ends at"),
        "a link of the plane": ("[model]\nmass = {pelvis = 1.1}", r"\[model\] mass = .*no range"),
        "a shift of all": ("[model]\ncom = 0.01", r"\[model\] com = 0.01: bodies have axes of their own"),
        "a lopsided error": ("[model]\nmass = {from = 0.9, to = 1.3}", r"\[model\] mass = .*write {within"),
        "a weightless robot": ("[model]\nmass = 0.0", r"\[model\] mass = 0.0.*below 0.05"),
        "lengths": ("[model]\nlength = 1.1", r"\[model\]: unknown key 'length'"),
        "torque limits": ("[disturbances]\ntorque_limits = [50.0, 50.0]", "unknown key 'torque_limits'"),
        "negative noise": ("[disturbances]\nvelocity_noise = -0.1", "velocity_noise = -0.1.*below 0 rad/s"),
        "speeds upside down": ("[expect]\nwalking_speed = [0.3, 0.1]", "walking_speed = .*exchange them"),
    }.items()
}
MALFORMED |= {
    "a speed in the plane": ("speed = 0.2", "speed = 0.2.*write space = true"),
    "a command in the plane": ("[[command]]\nstep = 1\nspeed = 0.1", "command = .*write space = true"),
    "a heading in the plane": ("[expect]\nyaw_drift = 0.1", "yaw_drift: measured in space only"),
    "a flag of space that is none": ("space = 1", "space = 1.*true nor false"),
}
MALFORMED |= {
    "a number of 5000 digits": ("steps = " + "9" * 5000, "a whole number has thousands of digits"),
    "a number that Python does not print": ("steps = 0x" + "f" * 6000, "steps = a number of thousands of digits"),
    "a date": ("steps = 1979-05-27", "steps = datetime.date.*whole number"),
    "a time of day for a friction": ("[disturbances]\nfriction = 07:32:00", "friction = datetime.time.*finite number"),
    "a date in a specification": ("[gait]\nfriction = 1979-05-27", "gait = .*friction.*not a finite number"),
    "a date for a controller of one's own": (
        '[controller]\ntype = "math:hypot"\narguments = {day = 1979-05-27}',
        "day = datetime.date.*neither number, text",
    ),
    "an endless number for it": (
        '[controller]\ntype = "math:hypot"\narguments = {"a\\nb" = [inf]}',
        r"arguments\] 'a\\nb' = \[inf\]: neither number, text",
    ),
    "a robot whose name ends early": ('robot = "a\\u0000.toml"', "robot = 'a.x00.toml'.*not text"),
    "a robot that a terminal obeys": ('robot = "\\u001b[2J"', "robot = '.x1b.2J'.*not text"),
    "a robot of 5000 letters": (f'robot = "{"x" * 5000}"', "robot = 'xxx.*not text"),
    "a push at a step of 5000 digits": (
        f'[[push]]\nimpulse = 1.0\nat = "impact of step {"9" * 900}"',
        "at = 'impact of step 999.*not understood",
    ),
    "a push at a step in other digits": (
        '[[push]]\nimpulse = 1.0\nat = "impact of step ١"',
        "at = 'impact of step ١'.*not understood",
    ),
    "a key of 3000 letters": ("k" * 3000 + " = 1", "unknown key 'kkk"),
    "a key of thousands of dots": ("a" + ".a" * 5000 + " = 1", "a key has more than 50 dots"),
    "a key that a terminal obeys": ('"\\u001b[2J" = 1', "unknown key '.x1b.2J'"),
    "more steps than anybody walks": ("steps = 1000000000000", "steps = 1000000000000.*from 1 to 100000"),
    "more trials than anybody runs": ("repeat = 1000000000000", "repeat = 1000000000000.*from 1 to 1000000"),
    "a table without end": (
        "[model]\nmass = {" + ", ".join(f"b{i} = 1" for i in range(20_000)) + "}",
        "unknown key 'b0'",
    ),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_one_line_and_status_2(case, write, capsys):
    text, complaint = MALFORMED[case]
    path = write(text)
    assert main(["trial", str(path)]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert error.startswith(f"frontal-biped: error: {path}")
    assert len(error) < 1500 and error.strip().isprintable()
    assert re.search(complaint, error), error


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["nowhere.toml"], "nowhere.toml: no such file"),
        (["{}", "--repeat", "5"], "--repeat 5: nothing in the scenario is random"),
        (["{}", "{}"], "has it too; give it another"),
        (["{}", "--junit", "{}/junit.xml"], "is not a folder"),
        (["{}", "--save", "{}"], "ends as a file does; write the folder"),
    ],
)
def test_bad_command_lines_too(arguments, complaint, write, capsys):
    path = write("steps = 1")
    assert main(["trial", *(argument.format(path) for argument in arguments)]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert complaint in error
