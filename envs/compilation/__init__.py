"""Plain Python loops compiled together with the plain methods of the named tuples that they drive."""

from envs.compilation.kernels import CompilationError, cache_directory, compile_loop, entry_point

__all__ = ["CompilationError", "cache_directory", "compile_loop", "entry_point"]
