"""Sarsa(lambda) with binary features."""

from typing import Literal

from agents.algorithms.linear import Linear, LinearAgent, value_of
from agents.contract import Observation
from agents.learning.targets import bootstrapped
from agents.learning.traces import TraceKind, Traces
from agents.parameters.declared import Probability
from agents.parameters.validation import extends


class SarsaLambda(LinearAgent[Traces]):
    """On-policy control in which each error changes the values of the steps before, the latest the most."""

    __slots__ = ()
    name = "sarsa-lambda"
    citation = "Sarsa(lambda) with binary features: Sutton & Barto 2018, 12.7; Singh & Sutton 1996."

    @classmethod
    @extends(Linear.create)
    def create(
        cls,
        linear: Linear,
        *,
        trace_decay: Probability = 0.9,
        traces: Literal["accumulating", "replacing"] = "replacing",
        clear_others: bool = False,
    ) -> "SarsaLambda":
        """The agent before it has learned anything.

        Args:
            linear: see ``Linear.create``.
            trace_decay: lambda, in [0, 1].
            traces: ``"accumulating"``: a visit adds 1; ``"replacing"``: it sets to 1.
            clear_others: whether a visit also removes the traces of the actions not taken there.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        kind, decay = TraceKind[traces.upper()], linear.discount * trace_decay
        return cls.with_memory(linear, Traces.of(linear.weights, kind, decay, clear_others=clear_others))

    def begin_episode(self) -> None:
        """Forget the traces of the episode before."""
        self.memory.clear()

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Towards the reward and the value of the next action, in proportion to the traces."""
        (here, there), target = self.scratch, reward
        self.features.fill(observation, here)
        if not terminated:
            self.features.fill(next_observation, there)
            target = bootstrapped(reward, self.discount, value_of(self.weights, there, next_action))
        error = target - value_of(self.weights, here, action)
        self.memory.visit(here, action, self.step_size)
        self.memory.learn(self.weights, self.step_size * error)
