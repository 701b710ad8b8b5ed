"""n-step Sarsa with binary features."""

from agents.algorithms.linear import Linear, LinearAgent, add, value_of
from agents.contract import Observation
from agents.learning.step_buffer import StepBuffer
from agents.learning.targets import bootstrapped
from agents.parameters.declared import Count
from agents.parameters.validation import extends


class SemiGradientSarsa(LinearAgent[StepBuffer]):
    """On-policy control that learns from the n next rewards and the value of what follows them.

    The step n - 1 before the current one is learned; at the goal all that wait. Those that wait when a
    time limit ends an episode are learned when the next begins, from the rewards there were and the
    value of the last observation and the action chosen there. After an episode without a next, the
    last one of the training, they stay unlearned: up to n - 1 steps.
    """

    __slots__ = ()
    name = "semi-gradient-sarsa"
    citation = "Semi-gradient n-step Sarsa: Sutton & Barto 2018, 10.1 (n = 1) and 10.2."

    @classmethod
    @extends(Linear.create)
    def create(cls, linear: Linear, *, n: Count = 1) -> "SemiGradientSarsa":
        """The agent before it has learned anything.

        Args:
            linear: see ``Linear.create``.
            n: steps until an estimated value takes the place of rewards.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        return cls.with_memory(linear, StepBuffer.with_capacity(n, linear.features.active))

    def begin_episode(self) -> None:
        """Learn what a time limit left over."""
        steps = self.memory
        last = steps.cursor[0]
        while steps.pending[0] > 0:
            self.learn_oldest(value_of(self.weights, steps.states[last], steps.actions[last]))

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Remember this step, learn the one n - 1 before it."""
        steps = self.memory
        steps.append(self.features, observation, action, reward, next_observation, next_action)
        if terminated:
            while steps.pending[0] > 0:
                self.learn_oldest(0.0)
        elif steps.is_full():
            self.learn_oldest(value_of(self.weights, steps.states[steps.cursor[0]], next_action))

    def learn_oldest(self, next_value: float) -> None:
        """Learn the oldest step that waits.

        Args:
            next_value: value of what follows the newest step.
        """
        steps, target = self.memory, next_value
        for age in range(1, steps.pending[0] + 1):
            target = bootstrapped(steps.rewards[steps.back(age)], self.discount, target)
        place = steps.back(steps.pending[0])
        active, action = steps.states[place], steps.actions[place]
        change = self.step_size * (target - value_of(self.weights, active, action))
        add(self.weights, active, action, change)
        steps.pending[0] -= 1
