"""The built-in tournament of all kinds of agents."""

from agents.registry import BUILT_IN
from arena import Evaluation, Tournament, Training, field, run


def test_every_built_in_agent_that_races_in_a_moment_is_in_the_field() -> None:
    entered = {entrant.agent for entrant in field().entrants}
    slow = {"fitted-q-iteration"}
    assert {name for name, agent in BUILT_IN.items() if agent not in entered} <= slow


def test_the_field_races_compiled() -> None:
    short = Tournament(
        field(replicates=1).entrants,
        training=Training(episodes=3, max_steps=200),
        evaluation=Evaluation(episodes=2, max_steps=200),
        replicates=1,
    )
    frame = run(short, n_jobs=2).frame()
    assert set(frame["driver"]) == {"compiled"}
    assert set(frame["status"]) == {"finished"}
