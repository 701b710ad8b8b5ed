"""A forest of randomized regression trees (Geurts, Ernst & Wehenkel 2006) whose leaves can be filled anew."""

from typing import Any

import numpy as np

from agents.contract import Floats, Integers


class Forest:
    """Trees over points; each predicts the mean target of the points in a leaf, the forest the mean of all.

    Args:
        points: float64, shape (points, dimensions).
        targets: float64, shape (points,): what the trees are grown to.
        tries: splits drawn at each node, of which the best is taken; 1 is a split at random.
        parameters: of ``sklearn.ensemble.ExtraTreesRegressor``.

    Attributes:
        means: float64: the prediction of each leaf, all trees in a row.
    """

    def __init__(self, points: Floats, targets: Floats, tries: int, **parameters: Any) -> None:
        from sklearn.ensemble import ExtraTreesRegressor

        self.trees = ExtraTreesRegressor(**parameters, max_features=tries, n_jobs=1).fit(points, targets)
        nodes = [tree.tree_.node_count for tree in self.trees.estimators_]
        self.offsets = np.cumsum([0, *nodes[:-1]])
        self.own = self.leaves(points)
        self.counts = np.maximum(np.bincount(self.own.ravel(), minlength=sum(nodes)), 1)
        self.fill(targets)

    def leaves(self, points: Floats) -> Integers:
        """The leaves in which points are, shape (points, trees)."""
        return np.asarray(self.trees.apply(points) + self.offsets)

    def fill(self, targets: Floats) -> None:
        """Let the leaves predict other targets of the same points; the trees stay as they are."""
        weights = np.repeat(targets, self.own.shape[1])
        self.means = np.bincount(self.own.ravel(), weights, len(self.counts)) / self.counts

    def predict(self, leaves: Integers) -> Floats:
        """The predictions for points in these leaves, shape (points,)."""
        return np.asarray(self.means[leaves].mean(axis=1))
