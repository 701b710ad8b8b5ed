"""Loops in C, for comparison: built where there is a compiler."""

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any

PHYSICS = r"""
#include <math.h>

/* One step on the default hill, to the bit that of envs.hill. */
static inline void move(double *x, double *v, int64_t action)
{
    *v += (action - 1) * 0.001 + cos(3.0 * *x) * -0.0025;
    if (*v < -0.07) *v = -0.07;
    if (*v > 0.07) *v = 0.07;
    *x += *v;
    if (*x < -1.2) *x = -1.2;
    if (*x > 0.6) *x = 0.6;
    if (*x == -1.2 && *v < 0.0) *v = 0.0;
}
"""


def built(source: str, function: str, folder: Path) -> Any:
    """The function of ``source``, built in ``folder``; None where there is no compiler.

    ``source`` may call ``move``. Without fused multiply-add, which would change bits.
    """
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    text, library = folder / f"{function}.c", folder / f"{function}.so"
    text.write_text("#include <stdint.h>\n" + PHYSICS + source)
    options = ["-O3", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run([compiler, *options, str(text), "-o", str(library), "-lm"], check=True)
    return getattr(ctypes.CDLL(str(library)), function)
