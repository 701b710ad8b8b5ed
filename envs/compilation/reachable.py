"""What a compiled loop can reach: the plain functions and classes behind it, and their fingerprint.

Numba caches machine code on disk but notices only edits of the file that holds the loop itself, so an
edited agent or hill would silently keep running its old code. The fingerprint covers all the code that
is compiled in, whatever file, notebook cell or plugin it comes from.
"""

import enum
import hashlib
import inspect
import types
import typing
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

# Code of these packages is fixed by their versions, or is a primitive of the compiler.
_FOREIGN = {"builtins", "math", "cmath", "numpy", "numba", "typing", "collections", "enum", "operator"}
# Methods that a named tuple has anyway; classmethods and properties are not compiled.
_GENERATED = {*vars(typing.NamedTuple("_", [])), "__new__", "__getnewargs__"}


class ReachableCode:
    """The functions, named-tuple classes and constants that ``roots`` can reach.

    Attributes:
        functions: plain functions, in the order found.
        methods: the plain methods of the named-tuple classes found.
    """

    def __init__(self, *roots: object) -> None:
        self.functions: list[Callable[..., Any]] = []
        self.methods: list[Callable[..., Any]] = []
        self._seen: set[int] = set()
        self._facts: set[str] = set()
        for number, root in enumerate(roots):
            self._facts.add(f"root {number}: {structure(root)}")
            self._visit(root)

    def fingerprint(self) -> str:
        """A digest that changes with any code, constant or type that would be compiled in."""
        return hashlib.sha256("\n".join(sorted(self._facts)).encode()).hexdigest()[:32]

    def _visit(self, value: object) -> None:
        if id(value) in self._seen:
            return
        self._seen.add(id(value))
        if isinstance(value, type):
            self._visit_class(value)
        elif isinstance(value, types.FunctionType):
            if not _foreign(value):
                self.functions.append(value)
                self._visit_code(value)
        elif hasattr(value, "py_func"):  # compiled by its author with numba.njit
            self._visit_code(value.py_func)
        elif hasattr(value, "_fields"):
            self._visit_class(type(value))
            for field in value:  # type: ignore[attr-defined]  # a named tuple
                self._visit(field)

    def _visit_class(self, cls: type) -> None:
        if _foreign(cls):
            return
        if issubclass(cls, enum.Enum):
            self._facts.add(f"{_name(cls)}: {[(m.name, m.value) for m in cls]!r}")
        elif hasattr(cls, "_fields"):
            attributes = {name: v for base in reversed(cls.__mro__) for name, v in vars(base).items()}
            for name, method in attributes.items():
                if isinstance(method, types.FunctionType) and name not in _GENERATED:
                    self.methods.append(method)
                    self._visit_code(method, owner=_name(cls))

    def _visit_code(self, function: types.FunctionType, owner: str = "") -> None:
        cells = [cell.cell_contents for cell in function.__closure__ or ()]
        self._facts.add(
            f"{owner} {_name(function)}: {_code(function.__code__)} {function.__defaults__!r} "
            f"{[structure(c) + repr(c) for c in cells if _constant(c)]}"
        )
        for cell in cells:
            self._visit(cell)
        for value, name in _globals(function):
            if _constant(value):
                self._facts.add(f"{_name(function)}: {name} = {_literal(value)}")
            else:
                self._visit(value)


def module_code(module: types.ModuleType) -> str:
    """A digest of the functions, and the methods of the classes, that ``module`` defines."""
    digests: set[str] = set()
    pending = [part for part in vars(module).values() if getattr(part, "__module__", "") == module.__name__]
    while pending:
        part = inspect.unwrap(pending.pop())
        if isinstance(part, type):
            members = (getattr(m, "__func__", getattr(m, "fget", m)) for m in vars(part).values())
            pending += [member for member in members if isinstance(member, types.FunctionType)]
        elif isinstance(part, types.FunctionType):
            digests.add(f"{_name(part)}: {_code(part.__code__)}")
    return hashlib.sha256("\n".join(sorted(digests)).encode()).hexdigest()


def structure(value: object) -> str:
    """The shape of a value as the compiler sees it: classes, array types, tuple lengths; no contents."""
    if isinstance(value, np.ndarray):
        return f"array({value.dtype},{value.ndim},{value.flags.c_contiguous},{value.flags.writeable})"
    if isinstance(value, tuple):
        return f"{_name(type(value))}({','.join(map(structure, value))})"
    return _name(type(value))


def _globals(function: types.FunctionType) -> Iterator[tuple[object, str]]:
    """The global objects that the function's code names, also as attributes of modules."""
    names = set(_names(function.__code__))
    modules = [function.__globals__]
    while modules:
        namespace = modules.pop()
        for name in sorted(names & namespace.keys()):
            value = namespace[name]
            if isinstance(value, types.ModuleType):
                if value.__name__.partition(".")[0] not in _FOREIGN and id(vars(value)) != id(namespace):
                    modules.append(vars(value))
            else:
                yield value, name


def _names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _names(constant)


def _code(code: types.CodeType) -> str:
    constants = [_code(c) if isinstance(c, types.CodeType) else _literal(c) for c in code.co_consts]
    return f"{code.co_code.hex()} {constants} {code.co_names} {code.co_varnames} {code.co_freevars}"


def _literal(value: object) -> str:
    if isinstance(value, frozenset):
        return repr(sorted(map(repr, value)))
    if isinstance(value, np.ndarray):
        return f"{structure(value)} {hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()}"
    return repr(value)


def _constant(value: object) -> bool:
    return isinstance(value, (bool, int, float, complex, str, bytes, tuple, np.ndarray, np.generic))


def _foreign(definition: Any) -> bool:
    return (getattr(definition, "__module__", None) or "builtins").partition(".")[0] in _FOREIGN


def _name(definition: Any) -> str:
    return f"{definition.__module__}.{definition.__qualname__}"
