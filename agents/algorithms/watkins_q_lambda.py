"""Watkins's Q(lambda) with binary features."""

from agents.algorithms.linear import best_action_of, value_of
from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.contract import Observation
from agents.learning.targets import bootstrapped
from agents.parameters.validation import extends


class WatkinsQLambda(SarsaLambda):
    """Off-policy control: errors reach back as far as the actions since were greedy.

    An action that is as good as the best one is greedy.
    """

    __slots__ = ()
    name = "watkins-q-lambda"
    citation = (
        "Watkins's Q(lambda) with binary features: "
        "Watkins 1989; Sutton & Barto 1998, 7.6 and 8.3; 2018, 12.10."
    )

    @classmethod
    @extends(SarsaLambda.create, omit=["clear_others"])
    def create(cls, agent: SarsaLambda) -> "WatkinsQLambda":
        """The agent before it has learned anything.

        Args:
            agent: see ``SarsaLambda.create`` and ``Linear.create``.
        """
        return cls(*agent)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Towards the reward and the best next value; then cut the traces if the next action explores."""
        (here, there), target, explores = self.scratch, reward, False
        self.features.fill(observation, here)
        if not terminated:
            self.features.fill(next_observation, there)
            best = value_of(self.weights, there, best_action_of(self.weights, there))
            explores = value_of(self.weights, there, next_action) < best
            target = bootstrapped(reward, self.discount, best)
        error = target - value_of(self.weights, here, action)
        self.memory.visit(here, action, self.step_size)
        self.memory.learn(self.weights, self.step_size * error)
        if explores:
            self.memory.clear()
