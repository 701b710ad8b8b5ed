"""Find the parameters of the built-in tournament ``field``: a search that can be repeated and continued.

    python scripts/tune_field.py --trials 40                # all agents; again to continue
    python scripts/tune_field.py --trials 40 --agent sarsa-lambda
    python scripts/tune_field.py --write arena/data/field.toml

For each agent Optuna's TPE sampler minimizes the mean number of steps to the goal, a failure counted at
the limit. The seeds of the search are not the tournament's: what is chosen here is tested there on other
starts, with other random numbers. Studies are kept in ``runs/tuning.sqlite``.
"""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import optuna

from agents import HarmonicRate, LinearDecay, Softmax, UpperConfidence, agent_class
from arena import Entrant, Evaluation, Tournament, Training, run
from arena.common.plain import plain

TRAINING = Training(episodes=2000, max_steps=2000)
EVALUATION = Evaluation(episodes=500)
SEED, REPLICATES = 1_000_000, 4
STUDIES = "sqlite:///runs/tuning.sqlite"

Space = Callable[[optuna.Trial], dict[str, Any]]


def bins(trial: optuna.Trial) -> dict[str, Any]:
    """A grid."""
    return {"bins": (trial.suggest_int("n_p", 8, 60), trial.suggest_int("n_v", 8, 60, step=2))}


def epsilon(trial: optuna.Trial) -> LinearDecay:
    """Less and less exploration, none in the end."""
    start = trial.suggest_float("epsilon", 0.0, 0.6)
    return LinearDecay(start, 0.0, trial.suggest_float("until", 0.2, 1.0))


def rate(trial: optuna.Trial) -> HarmonicRate:
    """Step sizes that fall with the visits."""
    start = trial.suggest_float("alpha", 0.03, 1.0, log=True)
    return HarmonicRate(start, 1.0, trial.suggest_float("fall", 1e-5, 0.1, log=True))


def tabular(trial: optuna.Trial) -> dict[str, Any]:
    """Agents with a table that is learned step by step."""
    discount = trial.suggest_categorical("discount", [0.99, 0.995, 1.0])
    return {**bins(trial), "epsilon": epsilon(trial), "step_size": rate(trial), "discount": discount}


def linear(trial: optuna.Trial) -> dict[str, Any]:
    """Agents with tile coding."""
    return {
        "tilings": trial.suggest_categorical("tilings", [4, 8, 16, 32]),
        "tiles": trial.suggest_int("tiles", 4, 16),
        "step_size": trial.suggest_float("alpha", 0.02, 1.5, log=True),
        "epsilon": LinearDecay(trial.suggest_float("epsilon", 0.0, 0.1), 0.0),
    }


def traced(trial: optuna.Trial) -> dict[str, Any]:
    """Agents with tile coding and traces."""
    return {**linear(trial), "trace_decay": trial.suggest_float("trace_decay", 0.5, 0.99)}


def planned(trial: optuna.Trial) -> dict[str, Any]:
    """Agents with a model of the cells."""
    return {**bins(trial), "discount": trial.suggest_categorical("discount", [0.99, 0.995, 1.0])}


def softmax(trial: optuna.Trial) -> dict[str, Any]:
    """Softmax in place of epsilon-greedy exploration."""
    start = trial.suggest_float("temperature", 0.05, 5.0, log=True)
    explore = Softmax(start, start * trial.suggest_float("cooling", 0.001, 1.0, log=True))
    return {**bins(trial), "step_size": rate(trial), "explore": explore}


def upper_confidence(trial: optuna.Trial) -> dict[str, Any]:
    """Upper confidence bounds in place of epsilon-greedy exploration."""
    explore = UpperConfidence(trial.suggest_float("c", 0.01, 10.0, log=True))
    return {**bins(trial), "step_size": rate(trial), "explore": explore}


# Entrants of the field: name, agent, what is searched.
ENTRANTS: dict[str, tuple[str, Space]] = {
    "q-learning": ("q-learning", tabular),
    "sarsa": ("sarsa", tabular),
    "expected-sarsa": ("expected-sarsa", tabular),
    "double-q-learning": ("double-q-learning", tabular),
    "n-step-sarsa": ("n-step-sarsa", lambda trial: tabular(trial) | {"n": trial.suggest_int("n", 2, 16)}),
    "monte-carlo": ("monte-carlo", tabular),
    "q-learning softmax": ("q-learning", softmax),
    "q-learning ucb": ("q-learning", upper_confidence),
    "dyna-q": ("dyna-q", lambda trial: tabular(trial) | {"planning": trial.suggest_int("planning", 1, 20)}),
    "prioritized-sweeping": (
        "prioritized-sweeping",
        lambda trial: (
            planned(trial) | {"epsilon": epsilon(trial), "planning": trial.suggest_int("planning", 2, 30)}
        ),
    ),
    "r-max": ("r-max", lambda trial: planned(trial) | {"known": trial.suggest_int("known", 1, 20)}),
    "semi-gradient-sarsa": (
        "semi-gradient-sarsa",
        lambda trial: linear(trial) | {"n": trial.suggest_int("n", 1, 16)},
    ),
    "sarsa-lambda": ("sarsa-lambda", traced),
    "true-online-sarsa": ("true-online-sarsa", traced),
    "watkins-q-lambda": ("watkins-q-lambda", traced),
}


def steps(name: str, parameters: dict[str, Any]) -> float:
    """Mean steps to the goal of the learned policies; failures count as the limit."""
    entrant = Entrant(name, agent_class(ENTRANTS[name][0]), **parameters)
    tournament = Tournament(
        (entrant,), training=TRAINING, evaluation=EVALUATION, replicates=REPLICATES, seed=SEED
    )
    with run(tournament) as results:
        return float(results.frame()["steps"].fillna(EVALUATION.max_steps).mean())


def tune(name: str, trials: int) -> optuna.Study:
    """Search until the study has ``trials`` trials."""
    study = optuna.create_study(
        storage=STUDIES, study_name=name, load_if_exists=True, sampler=optuna.samplers.TPESampler(seed=0)
    )
    space = ENTRANTS[name][1]

    def objective(trial: optuna.Trial) -> float:
        parameters = space(trial)
        trial.set_user_attr("parameters", {key: plain(value) for key, value in parameters.items()})
        return steps(name, parameters)

    study.optimize(objective, n_trials=max(0, trials - len(study.trials)))
    return study


def toml(value: Any) -> str:
    """A plain value as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, float):
        return f"{value:.6g}" if "." in f"{value:.6g}" or "e" in f"{value:.6g}" else f"{value:.1f}"
    return f'"{value}"' if isinstance(value, str) else str(value).lower()


def describe(study: optuna.Study) -> str:
    """The best trial as an entrant of a tournament file."""
    best = study.best_trial
    found = f"# best of {len(study.trials)} trials: {best.value:.2f} steps on the seeds of the search"
    name, agent = study.study_name, ENTRANTS[study.study_name][0]
    return f"{found}\n{entry(agent, best.user_attrs['parameters'], name)}"


def entry(agent: str, parameters: dict[str, Any], name: str | None = None) -> str:
    """An entrant of a tournament file."""
    lines = ["[[entrants]]", *([f'name = "{name}"'] if name else []), f'agent = "{agent}"']
    if parameters:
        lines += ["[entrants.parameters]", *(f"{key} = {toml(value)}" for key, value in parameters.items())]
    return "\n".join(lines)


HEAD = f"""\
# The built-in tournament "field". Written by scripts/tune_field.py: what its search found.
name = "field"

[training]
episodes = {TRAINING.episodes}
max_steps = {TRAINING.max_steps}
"""

# Entrants without anything to search for. Fitted Q iteration is not here: it is for tens of episodes.
FIXED: dict[str, dict[str, Any]] = {
    "tutorial": {},
    "xiao": {},
    "momentum": {},
    "random": {},
    "value-iteration": {"bins": (40, 40), "polish": 20},
    "optimal": {},
}


def main() -> None:
    """Parse, search, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=0, help="of each study, those before included")
    parser.add_argument("--agent", choices=ENTRANTS, action="append", help="all, if left out")
    parser.add_argument("--write", type=Path, help="write the tournament file")
    arguments = parser.parse_args()
    Path("runs").mkdir(exist_ok=True)
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    told = []
    for name in arguments.agent or ENTRANTS:
        study = tune(name, arguments.trials)
        told.append(describe(study))
        print(told[-1], end="\n\n", flush=True)
    if arguments.write:
        told += [entry(agent, parameters) for agent, parameters in FIXED.items()]
        arguments.write.write_text("\n".join([HEAD, "\n\n".join(told), ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
