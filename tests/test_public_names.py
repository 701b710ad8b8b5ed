"""What is public, name by name: a name that comes or goes is meant, and stands here, too."""

import ast
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

import pytest
from fresh import output_of
from paths import ROOT

PUBLIC = {
    "arena": """
        ArenaError Entrant Evaluation InterruptedWalk Policy PolicyAgent RandomWalk Results
        Tournament Training field load load_plugin paper quick random_walk run sweep
    """,
    "arena.analysis": """
        SCORES Leaderboard Scores Standing area compare_entrants fewest_steps improvement
        leaderboard learning_curves map_of moving_average regressions reward_curves scores_of
        settled
    """,
    "arena.figures": """
        draw_hill draw_intervals draw_learning draw_lengths draw_pairs draw_phase draw_policy
        draw_ranks draw_regret draw_sweep draw_value draw_visits race save_race
    """,
    "arena.plugins": "PluginError load_plugin",
    "arena.reproduction": """
        PAPER Claim Comparison Fit WalkStudy compare fit iterations_spread paper_claims paper_tables
        published results_claims study
    """,
    "arena.results": "Results ResultsError Trained UnknownPolicyError digest load",
    "arena.testing": "Finding check_agent findings parametrize_with_checks",
    "arena.tournament": """
        Conditions Entrant Evaluation Run Tournament Training from_dict load_tournament sweep
    """,
    "agents": """
        Agent Grid HarmonicRate LinearDecay MomentumAgent QLearning RandomAgent Sarsa Softmax Task
        UpperConfidence agent_class agent_name register
    """,
    "agents.parameters": """
        Count NonNegative Parameter Positive Probability StepSize extends inherits parameters_of settle_all
        validated
    """,
    "agents.optimal": "NEVER Optimal optimal_steps",
    "agents.discretization": "EdgeGrid Grid TileCoding Voronoi make_cells make_features",
    "envs": "ArenaError Dynamics Hill Integrator InvalidTypeError InvalidValueError",
    "envs.compilation": "CompilationError KernelInfo cache_directory compile_loop entry_point kernel_info",
    "envs.mountain_car_v0": "env parallel_env raw_env",
    "envs.single_car_v0": "SingleCarEnv",
    "envs.vector_car_v0": "VectorCarEnv",
    "envs.parked": "Parked",
}
IMPORT_ALL = """
import sys, warnings
from importlib import import_module
from pkgutil import walk_packages
warnings.simplefilter("ignore", DeprecationWarning)  # of modules that have moved
import agents, arena, arena.deprecated, envs
for package in (agents, arena, envs):
    for module in walk_packages(package.__path__, f"{package.__name__}."):
        if module.name != "arena.__main__":
            import_module(module.name)
for name in arena.deprecated.MOVED:
    import_module(name)
for face in sys.argv[1:]:
    for name in sys.modules[face].__all__:
        if isinstance(getattr(sys.modules[face], name), type(sys)):
            print(face, name)
"""


@pytest.mark.parametrize("face", PUBLIC)
def test_the_public_names_are_these(face: str) -> None:
    module = import_module(face)
    assert sorted(module.__all__) == sorted(PUBLIC[face].split())
    assert len({*module.__all__}) == len(module.__all__)
    for name in module.__all__:
        assert not isinstance(getattr(module, name), ModuleType)
        assert name in dir(module)


def test_no_module_bears_the_name_of_what_its_package_offers() -> None:
    for face in PUBLIC:
        module = import_module(face)
        modules = {found.name for found in iter_modules(getattr(module, "__path__", []))}
        assert modules & {*module.__all__} == set(), face


def test_no_import_puts_a_module_in_the_place_of_a_public_name() -> None:
    assert output_of(IMPORT_ALL, *PUBLIC) == ""


def test_no_other_module_offers_names() -> None:
    files = {path for package in ("agents", "arena", "envs") for path in (ROOT / package).rglob("*.py")}
    offering = {path.relative_to(ROOT) for path in files if "\n__all__ = " in path.read_text()}
    modules = {".".join(path.with_suffix("").parts).removesuffix(".__init__") for path in offering}
    assert modules == {*PUBLIC, "arena.cli"}  # of which the console script takes its entry


@pytest.mark.parametrize("package", ["arena", "envs"])
def test_a_name_that_is_imported_late_is_the_one_that_type_checkers_see(package: str) -> None:
    """They read the imports under ``if TYPE_CHECKING``, the program a table."""
    module = import_module(package)
    tree = ast.parse(Path(str(module.__file__)).read_text())
    (checking,) = (node for node in tree.body if isinstance(node, ast.If))
    imports = [node for node in checking.body if isinstance(node, ast.ImportFrom)]
    assert imports
    for node in imports:
        for name in (alias.name for alias in node.names):
            assert getattr(module, name) is getattr(import_module(str(node.module)), name)
