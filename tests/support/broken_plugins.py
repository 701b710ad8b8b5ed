"""The smallest agent, and what is wrong with files that are meant to hold it."""

DRIVER = """
class Driver:
    def act(self, observation, progress, rng):
        return 1

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        pass

    def greedy(self, observation):
        return 2 if observation[1] >= 0.0 else 0
"""
ACT = "(self, observation, progress, rng)"
CREATE = "must be a class method that takes (cls, task, *, its parameters)"
UNDECODABLE = "'utf-8' codec can't decode byte 0xe9 in position 5: invalid continuation byte"
BROKEN: dict[str, tuple[bytes | None, str]] = {
    "a syntax error": (b"class Driver\n", "plugin bad.py, line 1: SyntaxError: expected ':'"),
    "a package that is not installed": (
        f"import no_such_package\n{DRIVER}".encode(),
        "plugin bad.py, line 1: ModuleNotFoundError: No module named 'no_such_package'",
    ),
    "an exception when it is imported": (
        f"{DRIVER}\nraise RuntimeError('not\\n\\ntoday')\n".encode(),
        "plugin bad.py, line 12: RuntimeError: not today",
    ),
    "`sys.exit` when it is imported": (
        f"import sys\n\nsys.exit(3)\n{DRIVER}".encode(),
        "plugin bad.py, line 3: SystemExit: 3",
    ),
    "a method is missing": (
        DRIVER.replace("greedy", "best").encode(),
        "plugin bad.py: agent must have the methods act, learn, greedy; Driver lacks greedy",
    ),
    "a method with other arguments": (
        DRIVER.replace("progress, rng", "rng").encode(),
        f"plugin bad.py: Driver.act must take {ACT}, got (self, observation, rng)",
    ),
    "a `create` with parameters by place": (
        f"{DRIVER}\n    @classmethod\n    def create(cls, task, gain=1.0):\n        return cls()\n".encode(),
        f"plugin bad.py: Driver.create {CREATE}, got (task, gain=1.0) without the class",
    ),
    "a `create` that is no class method": (
        f"{DRIVER}\n    def create(cls, task):\n        return cls()\n".encode(),
        f"plugin bad.py: Driver.create {CREATE}, got (cls, task) without the class",
    ),
    "no agent in it": (
        b"GAIN = 1.0\n",
        "plugin bad.py defines no agent: a class with the methods act, learn and greedy",
    ),
    "the name of a built-in agent": (
        (DRIVER + DRIVER.replace("Driver", "Sarsa")).encode(),
        "plugin bad.py: agent 'sarsa' of plugin FOLDER/bad.py has a name that is taken: built in",
    ),
    "two classes of one name": (
        (DRIVER.replace("Driver", "DQNDriver") + DRIVER.replace("Driver", "DqnDriver")).encode(),
        "plugin bad.py: DQNDriver and DqnDriver would both be called 'dqn-driver'",
    ),
    "not UTF-8": (
        b"# caf\xe9 \n",
        f"plugin bad.py cannot be read: {UNDECODABLE}",
    ),
    "no such file": (None, "there is no plugin file bad.py"),
}
