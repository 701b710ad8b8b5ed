"""Loops in C, for comparison: built where there is a compiler."""

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any


def built(source: str, function: str, folder: Path) -> Any:
    """The function of ``source``, built in ``folder``; None where there is no compiler.

    Without fused multiply-add, which would change bits.
    """
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    text, library = folder / f"{function}.c", folder / f"{function}.so"
    text.write_text(source)
    options = ["-O3", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run([compiler, *options, str(text), "-o", str(library), "-lm"], check=True)
    return getattr(ctypes.CDLL(str(library)), function)
