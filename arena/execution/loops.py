"""The two loops of the arena, training and evaluation, of one car.

Plain Python: the compiled driver turns them into machine code together with the hill and the agent.
The PettingZoo driver runs the same steps for many cars at once.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation, learns_with_next_action
from arena.tournament.conditions import Conditions, Run

Lengths = NDArray[np.int64]
Transition = tuple[Any, int, float, Any]  # observation, action, reward, next observation
LearnAndAct = Callable[[Transition, bool, bool], int]  # a transition; terminated; over


class NoEpisodeHook(NamedTuple):
    """Stands in for an agent that does not ask when an episode begins."""

    nothing: int = 0  # numba needs a field

    def begin_episode(self) -> None:
        """Do nothing."""


def episode_hook(agent: Any) -> Any:
    """The agent itself if it has the optional method ``begin_episode``, else a hook that does nothing."""
    return agent if hasattr(agent, "begin_episode") else NoEpisodeHook()


class DrawsBefore(NamedTuple):
    """The order of SARSA and its kin: the next action is drawn, then learned with, then done."""

    nothing: int = 0

    def learn_and_act(
        self,
        loop: "TrainingLoop",
        progress: float,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
        over: bool,
    ) -> int:
        """Let the agent learn from a step; return its next action, drawn at the end of an episode, too."""
        next_action = checked(loop.agent.act(next_observation, progress, loop.action_rng), loop.n_actions)
        loop.agent.learn(observation, action, reward, next_observation, next_action, terminated)
        return next_action


class DrawsAfter(NamedTuple):
    """The order of Q-learning and its kin: an action is drawn from what was just learned."""

    nothing: int = 0

    def learn_and_act(
        self,
        loop: "TrainingLoop",
        progress: float,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
        over: bool,
    ) -> int:
        """Let the agent learn from a step; return its next action, this one again where none follows."""
        loop.agent.learn(observation, action, reward, next_observation, terminated)
        if over:
            return action
        return checked(loop.agent.act(next_observation, progress, loop.action_rng), loop.n_actions)


def learner_and_actor(agent: Any, act: Callable[[Any], int]) -> LearnAndAct:
    """``learn_and_act`` of the agent's order, in plain Python.

    Args:
        agent: what learns.
        act: asks it for an action, given an observation.
    """

    def act_and_learn(transition: Transition, terminated: bool, over: bool) -> int:
        next_action = act(transition[-1])
        agent.learn(*transition, next_action, terminated)
        return next_action

    def learn_and_act(transition: Transition, terminated: bool, over: bool) -> int:
        agent.learn(*transition, terminated)
        return transition[1] if over else act(transition[-1])

    return act_and_learn if learns_with_next_action(agent) else learn_and_act


def learning_order(agent: Any) -> DrawsBefore | DrawsAfter:
    """When the agent is asked for its next action: see ``agents.contract.Agent.learn``."""
    return DrawsBefore() if learns_with_next_action(agent) else DrawsAfter()


class TrainingLoop(NamedTuple):
    """What ``train`` needs and changes.

    Attributes:
        hill: the model of the car.
        agent: what drives and learns; changed in place.
        hook: whose ``begin_episode`` is called, see ``episode_hook``.
        order: whose ``learn_and_act`` is called, see ``learning_order``.
        n_actions: the actions are 0, 1, ..., n_actions - 1.
        episodes: number N_E of all episodes.
        max_steps: limit N_LE of an episode.
        start_rng: the stream that starts come from.
        action_rng: the stream of the agent's choices.
        lengths: filled with the steps of each episode, shape (episodes,).
    """

    hill: Any
    agent: Any
    hook: Any
    order: Any
    n_actions: int
    episodes: int
    max_steps: int
    start_rng: np.random.Generator
    action_rng: np.random.Generator
    lengths: Lengths


class EvaluationLoop(NamedTuple):
    """What ``evaluate`` needs and fills.

    Attributes:
        hill: the model of the car.
        agent: what drives; it does not learn.
        n_actions: the actions are 0, 1, ..., n_actions - 1.
        start_states: positions and velocities, shape (episodes, 2).
        max_steps: limit N_TS of an episode.
        lengths: filled with the steps of each episode, shape (episodes,).
        reached: filled with whether the goal was reached, shape (episodes,).
    """

    hill: Any
    agent: Any
    n_actions: int
    start_states: NDArray[np.float64]
    max_steps: int
    lengths: Lengths
    reached: NDArray[np.bool_]


def training_loop(conditions: Conditions, run: Run, agent: Any) -> TrainingLoop:
    """The training of a run, from its own random streams."""
    hill, training = conditions.hill, conditions.training
    return TrainingLoop(
        hill,
        agent,
        episode_hook(agent),
        learning_order(agent),
        hill.n_actions,
        training.episodes,
        training.max_steps,
        run.stream(conditions.seed, "start"),
        run.stream(conditions.seed, "act"),
        np.zeros(training.episodes, np.int64),
    )


def evaluation_loop(conditions: Conditions, run: Run, agent: Any) -> EvaluationLoop:
    """The evaluation of a run, from the starts that all entrants have."""
    hill, evaluation = conditions.hill, conditions.evaluation
    return EvaluationLoop(
        hill,
        agent,
        hill.n_actions,
        conditions.start_states(run.replicate),
        evaluation.max_steps,
        np.zeros(evaluation.episodes, np.int64),
        np.zeros(evaluation.episodes, np.bool_),
    )


def train(loop: TrainingLoop, first: int, last: int) -> None:
    """Let the agent learn (paper, section 4.3).

    Args:
        loop: what drives where.
        first: the episode to begin with.
        last: the episode to end before.

    Raises:
        ValueError: when the agent chooses an action that there is not.
    """
    hill, agent, n_actions, max_steps = loop.hill, loop.agent, loop.n_actions, loop.max_steps
    rng = loop.action_rng
    for episode in range(first, last):
        progress = episode / loop.episodes
        state = hill.reset(loop.start_rng)
        observation = hill.observe(state)
        loop.hook.begin_episode()
        action = checked(agent.act(observation, progress, rng), n_actions)
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            state, reward, terminated = hill.step(state, action)
            next_observation = hill.observe(state)
            steps += 1
            over = terminated or steps == max_steps
            action = loop.order.learn_and_act(
                loop, progress, observation, action, reward, next_observation, terminated, over
            )
            observation = next_observation
        loop.lengths[episode] = steps


def evaluate(loop: EvaluationLoop) -> None:
    """Drive greedily from each start (paper, section 4.3).

    Raises:
        ValueError: when the agent chooses an action that there is not.
    """
    hill, agent, n_actions, max_steps = loop.hill, loop.agent, loop.n_actions, loop.max_steps
    for episode in range(loop.start_states.shape[0]):
        state = (loop.start_states[episode, 0], loop.start_states[episode, 1])
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            action = checked(agent.greedy(hill.observe(state)), n_actions)
            state, _, terminated = hill.step(state, action)
            steps += 1
        loop.lengths[episode] = steps
        loop.reached[episode] = terminated


def checked(action: int, n_actions: int) -> int:
    """``action`` if there is such a one; else an agent's table would be read beyond its end.

    Raises:
        ValueError: when there is not.
    """
    if action < 0 or action >= n_actions:
        raise ValueError("action must be one of the hill's")
    return action
