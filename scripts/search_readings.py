"""Does a search that knows nothing of the reading ``as-run`` find it, or a better one?

    python scripts/search_readings.py --trials 300      # again to continue
    python scripts/search_readings.py --trials 300 --best 5 --replicates 10

Optuna searches the answers to what the text leaves open, or what a program may have done otherwise: the
start, what n counts and how fast the step size falls with it, the grid, the goal step and its reward, the
table at first, the wall, the end of the positions, when Q-learning draws its action. What it minimizes is the
root mean square of the relative differences between our iterations and the paper's 32 cells, from one
replicate. The best are run again with other seeds and more replicates: only that is a result, the search
itself is lucky. ``chance`` says how near a perfect reading would come: the same distance between one
replicate and the mean of the others. The study is kept in ``runs/readings.sqlite``.
"""

import argparse
import math
from pathlib import Path
from typing import Any

import optuna
from elimination import ITERATIONS, EarlyQLearning, iterations_of

from agents import HarmonicRate, LinearDecay, QLearning, Sarsa
from arena import Evaluation, Tournament, Training, run, sweep
from arena.reproduction import Fit, fit
from arena.tournament.builtin import PAPER_BINS
from envs import Hill

STUDY = "sqlite:///runs/readings.sqlite"
CENTRE = -math.pi / 6.0
STARTS = {"U(-0.6, -0.4)": (-0.6, -0.4)} | {
    f"-pi/6 +- {half:g}": (CENTRE - half, CENTRE + half) for half in (0.0, 0.01, 0.05, 0.1)
}


def chosen(trial: optuna.Trial) -> dict[str, Any]:
    """The answers of a trial, by name."""
    return {
        "start": trial.suggest_categorical("start", list(STARTS)),
        "n counts": trial.suggest_categorical("n counts", ["step", "episode", "state"]),
        "C": trial.suggest_categorical("C", [0.0, 0.0003, 0.001, 0.002, 0.003, 0.005, 0.01, 0.02]),
        "grid": trial.suggest_categorical("grid", ["n cells", "n edges"]),
        "goal": trial.suggest_categorical("goal", ["terminal", "bootstrap", "zero"]),
        "goal's reward": trial.suggest_categorical("goal's reward", [-1.0, 0.0]),
        "Q-learning draws": trial.suggest_categorical("Q-learning draws", ["before", "after"]),
        "table": trial.suggest_categorical("table", ["0", "U(-2, 0)", "U(-1, 0)", "U(0, 1)", "-1"]),
        "wall": trial.suggest_categorical("wall", ["stops", "does not stop"]),
        "greatest position": trial.suggest_categorical("greatest position", [0.6, math.pi / 6.0]),
        "epsilon": trial.suggest_categorical("epsilon", ["to the end", "to the half"]),
    }


def tournament(answers: dict[str, Any], replicates: int, seed: int) -> Tournament:
    """The paper's, under these answers."""
    table = answers["table"]
    uniform = table.startswith("U")
    low, high = STARTS[answers["start"]]
    parameters: dict[str, Any] = {
        "step_size": HarmonicRate(C=answers["C"]),
        "count_visits": answers["n counts"],
        "goal": answers["goal"],
        "initial_values": tuple(map(float, table[2:-1].split(","))) if uniform else float(table),
        "epsilon": LinearDecay(until=0.5 if answers["epsilon"] == "to the half" else 1.0),
        "binning": "digitize" if answers["grid"] == "n edges" else "uniform",
    }
    hill = Hill(
        min_start=low,
        max_start=high,
        inelastic_wall=answers["wall"] == "stops",
        max_position=answers["greatest position"],
        goal_reward=answers["goal's reward"],
    )
    q_learning = QLearning if answers["Q-learning draws"] == "after" else EarlyQLearning
    entrants = (
        *sweep("q-learning", q_learning, over={"bins": PAPER_BINS}, **parameters),
        *sweep("sarsa", Sarsa, over={"bins": PAPER_BINS}, **parameters),
    )
    return Tournament(entrants, hill, Training(), Evaluation(1, 1), replicates, seed, "search")


def fit_of(answers: dict[str, Any], replicates: int, seed: int) -> Fit:
    """How near our iterations are to the paper's, under these answers."""
    race = tournament(answers, replicates, seed)
    with run(race) as results:
        return fit(iterations_of(race, results), ITERATIONS)


def main() -> None:
    """Search, run the best again, print a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=300, help="of the study, those before included")
    parser.add_argument("--best", type=int, default=5, help="how many are run again")
    parser.add_argument("--replicates", type=int, default=10, help="of these")
    arguments = parser.parse_args()
    Path("runs").mkdir(exist_ok=True)
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    sampler = optuna.samplers.TPESampler(seed=0)
    study = optuna.create_study(
        storage=STUDY, study_name="readings of 0.2", load_if_exists=True, sampler=sampler
    )

    def objective(trial: optuna.Trial) -> float:
        return fit_of(chosen(trial), 1, seed=1_000_000).error

    study.optimize(objective, n_trials=max(0, arguments.trials - len(study.trials)))
    done = [trial for trial in study.trials if trial.value is not None]
    best: dict[str, optuna.trial.FrozenTrial] = {}
    for trial in sorted(done, key=lambda trial: trial.value or 0.0):
        best.setdefault(str(trial.params), trial)
    print(f"{len(done)} trials, {len(best)} different.\n")
    print("| reading | in the search | root mean square | correlation | chance |")
    print("|---|---:|---:|---:|---:|")
    for trial in list(best.values())[: arguments.best]:
        found = fit_of(trial.params, arguments.replicates, seed=0)
        reading = ", ".join(f"{name}: {_short(value)}" for name, value in trial.params.items())
        print(
            f"| {reading} | {trial.value:.2f}% | {found.error:.2f}% | {found.correlation:.3f} "
            f"| {found.chance:.2f}% |",
            flush=True,
        )


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
