"""True online Sarsa(lambda), by hand; test_sarsa_lambda has it against the book's box."""

from linear_walks import make, step, weights

from agents.algorithms.true_online_sarsa import TrueOnlineSarsa


def test_true_online_sarsa_by_hand() -> None:
    agent = make(TrueOnlineSarsa, trace_decay=0.5)
    agent.begin_episode()
    agent.learn(*step(0, 0, 8.0, 0, 0))
    # z = 1, and Q = Q' = Q_old = 0
    assert agent.weights.tolist() == weights({(0, 0): 0.5 * 8.0})
    agent.learn(*step(0, 0, 2.0, 1, 0))
    # z = 1/4 + 1 - 0.5 * 1/4 = 9/8; Q = 4, Q' = 0 and Q_old = 0, so the error is 2 - 4 = -2
    assert agent.weights.tolist() == weights(
        {(0, 0): 4.0 + 0.5 * (-2.0 + 4.0 - 0.0) * 9 / 8 - 0.5 * (4.0 - 0.0)}
    )
