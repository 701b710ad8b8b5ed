"""The queue by priority."""

from hypothesis import given
from hypothesis import strategies as st

from agents.models.priority_queue import PriorityQueue


@given(
    st.lists(
        st.one_of(
            st.none(), st.tuples(st.integers(0, 11), st.sampled_from([0.5, 1.0, 2.0]) | st.floats(0.1, 9))
        )
    )
)
def test_queue_gives_the_greatest_first(orders: list[tuple[int, float] | None]) -> None:
    queue, oracle = PriorityQueue.empty(12), dict[int, float]()
    for order in orders:
        if order is not None:
            queue.put(*order)
            oracle[order[0]] = order[1]
        elif oracle:
            number = queue.pop()
            assert oracle.pop(number) >= max(oracle.values(), default=0.0)
        assert queue.length[0] == len(oracle)
        assert set(queue.heap[: len(oracle)].tolist()) == oracle.keys()
        assert {n: queue.priorities[n] for n in range(12) if queue.priorities[n] > 0.0} == oracle
        assert {n for n in range(12) if queue.positions[n] >= 0} == oracle.keys()
    left = [oracle[queue.pop()] for _ in range(len(oracle))]
    assert left == sorted(oracle.values(), reverse=True)
