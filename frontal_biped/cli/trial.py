"""`frontal-biped trial`: run scenarios, print what they came to, exit 0 only if all expectations hold."""

import argparse
import json
import sys
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace

from frontal_biped.cli.main import SUCCESS, TASK_FAILED
from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import ScenarioError
from frontal_biped.files.atomic import require_folder, require_parent
from frontal_biped.library.executors import worker_processes
from frontal_biped.scenarios.file import load_scenario
from frontal_biped.scenarios.monte_carlo import run_trials
from frontal_biped.scenarios.report import markdown, table, write_junit
from frontal_biped.scenarios.run import TrialResult


def run_trial(arguments: argparse.Namespace) -> int:
    """Read all scenarios first, so that a bad one is told before the first step is walked."""
    scenarios = [load_scenario(path) for path in arguments.scenarios]
    if arguments.repeat is not None:
        for scenario in scenarios:
            if arguments.repeat > 1 and not scenario.random:
                raise ScenarioError(
                    f"{scenario.path}: --repeat {arguments.repeat}: nothing in the scenario is random, all trials would"
                    " be the same; leave --repeat out"
                )
    if arguments.only is not None:
        scenarios = [replace(scenario, expect=replace(scenario.expect, survival=1.0)) for scenario in scenarios]
    if arguments.junit is not None:
        require_parent(arguments.junit)
    if arguments.save is not None:
        require_folder(arguments.save)
    trials = len(scenarios) if arguments.only is not None else sum(arguments.repeat or s.repeat for s in scenarios)
    with Progress("walking: trial", trials) as progress, _executor(arguments) as executor:
        finished: list[TrialResult] = []

        def on_trial(done: int, total: int, result: TrialResult) -> None:
            finished.append(result)
            failed = sum(not each.passed for each in finished)
            progress.update(f"{result.scenario}{f', {failed} failed' if failed else ''}", done)

        def on_step(step: int) -> None:
            progress.update(f"step {step}", len(finished))

        progress.update("robot and gait", 0)
        results = run_trials(
            scenarios,
            repeat=arguments.repeat,
            seed=arguments.seed,
            numbers=None if arguments.only is None else [arguments.only],
            executor=executor,
            save=arguments.save,
            on_trial=on_trial,
            on_step=on_step,
        )
    if arguments.junit is not None:
        write_junit(results, arguments.junit)
    if arguments.json:
        content = {"passed": all(r.passed for r in results), "scenarios": [r.as_dict() for r in results]}
        sys.stdout.write(json.dumps(content, indent=1, allow_nan=False) + "\n")
    else:
        sys.stdout.write((markdown if arguments.markdown else table)(results) + "\n")
    if arguments.save is not None and not arguments.json:
        sys.stderr.write(f"runs in {arguments.save}; watch one with `frontal-biped view {arguments.save}/NAME-0.npz`\n")
    return SUCCESS if all(result.passed for result in results) else TASK_FAILED


def _executor(arguments: argparse.Namespace) -> AbstractContextManager[Executor | None]:
    return worker_processes(arguments.jobs) if arguments.jobs > 1 else nullcontext()
