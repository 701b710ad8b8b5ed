"""The modules of the user's own that an agent's module uses, found by the imports in their texts.

Its own are those of its top-level package; of a module that is in no package, of a script or a notebook,
those in its folder. Standard library and installed packages do not change while a process runs.
"""

import os
import re
import sysconfig
import types
from collections.abc import Iterator
from functools import cache
from pathlib import Path

# An import statement that begins a line. What only looks like one names a module that there is not.
_IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([.\w]+)[ \t]+import[ \t]*(\([^)]*|.*)|import[ \t]+(.*))", re.MULTILINE
)


def own_modules(module: types.ModuleType) -> dict[str, Path]:
    """The files of the modules that ``module`` uses, directly or through others, by name.

    Itself is among them unless it is a script, a notebook or a plugin, whose code travels.
    """
    name, file = module.__name__, getattr(module, "__file__", None)
    folder, package = Path(file).resolve().parent if file else Path.cwd(), ""
    if name == "__main__" or hasattr(module, "__arena_plugin__"):
        pending = set(_named(module)) - {name}
    else:
        pending = {name}
        for _ in range(name.count(".") + hasattr(module, "__path__")):
            folder, package = folder.parent, name.partition(".")[0]
    if not package and _is_installed(folder):
        return {}
    files: dict[str, Path | None] = {}  # of all that is named, own or not
    while pending:
        name = pending.pop()
        files[name] = _file(folder, name) if not package or name.partition(".")[0] == package else None
        if file := files[name]:
            imported = set(_imported(name, file, file.stat().st_mtime_ns))
            pending |= imported - files.keys()
    return {name: file for name, file in files.items() if file}


def _named(module: types.ModuleType) -> Iterator[str]:
    """The modules that are values of ``module``, or that its values come from."""
    for value in list(vars(module).values()):
        if isinstance(value, types.ModuleType):
            yield value.__name__
        else:
            definition = value if isinstance(value, (type, types.FunctionType)) else type(value)
            yield str(definition.__module__)


def _is_installed(folder: Path) -> bool:
    """Whether modules in ``folder`` have nothing to do with one another."""
    known = folder.name in ("site-packages", "dist-packages") or folder == Path(sysconfig.get_path("stdlib"))
    return known or any(folder.glob("*.dist-info"))


def _file(folder: Path, name: str) -> Path | None:
    """Where the text of the module ``name`` is in ``folder``, whether it is imported already or not."""
    stem = f"{folder}/{name.replace('.', '/')}"
    files = (file for file in (f"{stem}.py", f"{stem}/__init__.py") if os.path.isfile(file))  # noqa: PTH113 (faster)
    return next(map(Path, files), None)


@cache
def _imported(name: str, file: Path, _edited: int) -> tuple[str, ...]:
    """What the text imports; parts of packages, too, which may be modules."""
    imported: list[str] = []
    package = name if file.name == "__init__.py" else name.rpartition(".")[0]
    for base, parts, modules in _IMPORT.findall(file.read_text(encoding="utf-8-sig", errors="replace")):
        for module in modules.split(","):
            imported += re.findall(r"^\s*([.\w]+)", module)  # without its ``as``
        if base:
            up = len(base) - len(base.lstrip("."))
            above = package.rsplit(".", up - 1)[0] if up else ""
            whole = ".".join(filter(None, (above, base[up:])))
            imported += [whole, *(f"{whole}.{part}" for part in re.findall(r"\w+", parts))]
    return tuple(imported)
