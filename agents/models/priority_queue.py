"""A queue by priority: a binary heap (Williams 1964) in arrays, whose priorities can change."""

from typing import NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers


class PriorityQueue(NamedTuple):
    """Some of the numbers 0, ..., size - 1; that of the greatest priority comes out first.

    Attributes:
        heap: int64, shape (size,): the numbers in the queue. That at place k has no lesser priority
            than those at places 2k + 1 and 2k + 2.
        positions: int64, shape (size,): where each number is in the heap, -1 if it is not.
        priorities: float64, shape (size,): of each number, 0 if it is not in the queue.
        length: int64, shape (1,): how many are in the queue.
    """

    heap: Integers
    positions: Integers
    priorities: Floats
    length: Integers

    @classmethod
    def empty(cls, size: int) -> Self:
        """An empty queue for the numbers below ``size``."""
        return cls(np.zeros(size, np.int64), np.full(size, -1), np.zeros(size), np.zeros(1, np.int64))

    def put(self, number: int, priority: float) -> None:
        """Put ``number`` into the queue, or change its priority."""
        place = self.positions[number]
        if place < 0:
            place = self.length[0]
            self.length[0] += 1
        self.priorities[number] = priority
        while place > 0 and self.priority_at((place - 1) // 2) < priority:
            self.move(self.heap[(place - 1) // 2], place)
            place = (place - 1) // 2
        self.sink(number, place)

    def pop(self) -> int:
        """Take out the number of the greatest priority; there must be one."""
        number = self.heap[0]
        self.positions[number] = -1
        self.priorities[number] = 0.0
        self.length[0] -= 1
        if self.length[0] > 0:
            self.sink(self.heap[self.length[0]], 0)
        return number  # type: ignore[no-any-return]  # an array has it

    def sink(self, number: int, place: int) -> None:
        """Move ``number`` to ``place``, or so far below that nothing under it has a greater priority."""
        child = 2 * place + 1
        while child < self.length[0]:
            if child + 1 < self.length[0] and self.priority_at(child + 1) > self.priority_at(child):
                child += 1
            if self.priority_at(child) <= self.priorities[number]:
                break
            self.move(self.heap[child], place)
            place, child = child, 2 * child + 1
        self.move(number, place)

    def move(self, number: int, place: int) -> None:
        """Write ``number`` at ``place``."""
        self.heap[place] = number
        self.positions[number] = place

    def priority_at(self, place: int) -> float:
        """The priority of the number at ``place``."""
        return self.priorities[self.heap[place]]  # type: ignore[no-any-return]  # an array has it
