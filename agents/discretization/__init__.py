"""Cells and binary features of observations."""

from agents.discretization.cells import make_cells
from agents.discretization.edge_grid import EdgeGrid
from agents.discretization.features import make_features
from agents.discretization.grid import Grid
from agents.discretization.tile_coding import TileCoding
from agents.discretization.voronoi import Voronoi

__all__ = ["EdgeGrid", "Grid", "TileCoding", "Voronoi", "make_cells", "make_features"]
