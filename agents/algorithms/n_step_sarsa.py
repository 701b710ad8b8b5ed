"""n-step SARSA on cells."""

from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Observation
from agents.learning.step_buffer import StepBuffer
from agents.parameters.declared import Count
from agents.parameters.validation import extends


class NStepSarsa(TabularAgent[StepBuffer]):
    """On-policy control that learns from the n next rewards and the value of what follows them.

    The step n - 1 before the current one is learned; at the goal all that wait, the oldest first.
    Those that wait when a time limit ends an episode are learned when the next one begins, from the
    rewards there were and the value of the last cell and the action chosen there. After the last
    episode of the training, if a time limit ends it, up to n - 1 steps stay unlearned.
    """

    __slots__ = ()
    name = "n-step-sarsa"
    citation = "n-step SARSA: Watkins 1989, Cichosz 1995; Sutton & Barto 2018, section 7.2."

    @classmethod
    @extends(Tabular.create)
    def create(cls, table: Tabular, *, n: Count = 4) -> "NStepSarsa":
        """The agent before it has learned anything.

        Args:
            table: see ``Tabular.create``.
            n: steps until an estimated value takes the place of rewards; 1 is SARSA.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        return cls.with_memory(table, StepBuffer.with_capacity(n))

    def begin_episode(self) -> None:
        """Learn what a time limit left over."""
        while self.memory.pending[0] > 0:
            self.learn_oldest(False)
        self.update.begin_episode()

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
        steps.append(self.cells, observation, action, reward, next_observation, next_action)
        if terminated:
            while steps.pending[0] > 0:
                self.learn_oldest(True)
        elif steps.is_full():
            self.learn_oldest(False)

    def learn_oldest(self, terminated: bool) -> None:
        """Learn the oldest step that waits.

        Args:
            terminated: whether the newest step reached the goal.
        """
        steps, goal = self.memory, terminated
        next_value = self.values[steps.states[steps.cursor[0], 0], steps.actions[steps.cursor[0]]]
        for age in range(1, steps.pending[0]):
            next_value = self.update.target(steps.rewards[steps.back(age)], next_value, goal)
            goal = False
        place = steps.back(steps.pending[0])
        cell, action, reward = steps.states[place, 0], steps.actions[place], steps.rewards[place]
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, goal)
        steps.pending[0] -= 1
