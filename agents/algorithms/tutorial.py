"""The tutorial's Q-learning."""

from agents.algorithms.q_learning import QLearning
from agents.learning.schedules import LinearDecay
from agents.parameters.validation import extends


class TutorialQLearning(QLearning):
    """Q-learning with the tutorial's parameters in place of the paper's.

    Step size 0.1, discount 0.95, table from U(-2, 0), 20x20 cells, epsilon from 1 to 0 at half of the
    episodes, and a goal step sets the value to 0; the next action is drawn after the update. In one
    thing it differs: the tutorial makes no update in the step in which the time runs out. An agent is
    not told of the time limit, so here that step, one an episode, is learned like any other.
    """

    __slots__ = ()
    name = "tutorial"
    citation = "The Q-learning of the tutorial that the paper starts from, digitized."

    @classmethod
    @extends(
        QLearning.create,
        bins=20,
        discount=0.95,
        step_size=0.1,
        epsilon=LinearDecay(1.0, 0.0, 0.5),
        initial_values=(-2.0, 0.0),
        goal="zero",
    )
    def create(cls, agent: QLearning) -> "TutorialQLearning":
        """The agent before it has learned anything.

        Args:
            agent: see ``Tabular.create``; the defaults are the tutorial's.
        """
        return cls(*agent)
