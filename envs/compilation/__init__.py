"""Plain Python loops compiled together with the plain methods of the named tuples that they drive."""

from envs.compilation.kernel_folder import cache_directory
from envs.compilation.kernels import CompilationError, KernelInfo, compile_loop, entry_point, kernel_info

__all__ = [
    "CompilationError",
    "KernelInfo",
    "cache_directory",
    "compile_loop",
    "entry_point",
    "kernel_info",
]
