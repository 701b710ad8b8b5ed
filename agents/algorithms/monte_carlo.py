"""Monte Carlo control on cells."""

from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Observation
from agents.learning.step_buffer import StepBuffer
from agents.parameters.declared import Count
from agents.parameters.validation import extends


class MonteCarlo(TabularAgent[StepBuffer]):
    """Learns from what whole episodes return: every visit counts, and no value leans on another.

    An episode is learned at the goal, the newest step first. One that a time limit ends has no return;
    it is learned when the next one begins, and what it misses is taken to be the value of the last
    cell and the action chosen there. Without that the car may never see the goal: the empty table
    thrusts left, and what is never learned never changes. After the last episode of the training, if a
    time limit ends it, nothing is learned from it.
    """

    __slots__ = ()
    name = "monte-carlo"
    citation = (
        "On-policy every-visit Monte Carlo control: Sutton & Barto 2018, section 5.4; Singh & Sutton 1996."
    )

    @classmethod
    @extends(Tabular.create)
    def create(cls, table: Tabular, *, memory: Count = 30_000) -> "MonteCarlo":
        """The agent before it has learned anything.

        Args:
            table: see ``Tabular.create``. ``step_size=HarmonicRate(1, 1, 1)`` is the book's mean of all
                returns; it learns less well, for the returns of early, bad drives weigh as much as any.
            memory: steps of an episode that are remembered; of a longer one the earliest are forgotten.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        return cls.with_memory(table, StepBuffer.with_capacity(memory))

    def begin_episode(self) -> None:
        """Learn from an episode that a time limit ended."""
        self.learn_episode(False)
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
        """Remember this step; at the goal, learn from the episode."""
        self.memory.append(self.cells, observation, action, reward, next_observation, next_action)
        if terminated:
            self.learn_episode(True)

    def learn_episode(self, terminated: bool) -> None:
        """Learn all steps that wait, the newest first.

        Args:
            terminated: whether the newest reached the goal.
        """
        steps, goal = self.memory, terminated
        next_value = self.values[steps.states[steps.cursor[0], 0], steps.actions[steps.cursor[0]]]
        for age in range(1, steps.pending[0] + 1):
            place = steps.back(age)
            cell, action, reward = steps.states[place, 0], steps.actions[place], steps.rewards[place]
            self.update.apply(self.values, self.visits, cell, action, reward, next_value, goal)
            next_value = self.update.target(reward, next_value, goal)
            goal = False
        steps.pending[0] = 0
