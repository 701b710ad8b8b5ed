"""Numba told of the plain methods of named tuples."""

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any

from envs.compilation.reachable import ReachableCode

_registered: set[object] = set()

# LLVM inlines all calls: twice as fast as calls, and a quarter of the time that numba's own inlining takes.
_CALL = {"forceinline": True}


def _register(reached: ReachableCode) -> None:
    """Tell numba about the functions and methods that it has not seen."""
    from numba.extending import register_jitable

    _register_attributes()
    for function in [*reached.functions, *reached.methods]:
        if function not in _registered:
            _registered.add(function)
            register_jitable(**_CALL)(function)
    for method in reached.methods:
        _register_lowering(method)


@cache
def _register_attributes() -> None:
    """Let ``thing.method`` in compiled code mean the method of the named-tuple class of ``thing``.

    ``numba.extending.overload_method`` would bind a name to one signature for all classes; here
    each class keeps its own, so that unrelated plugins cannot disturb each other.
    """
    from numba import types
    from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr

    class PlainMethods(AttributeTemplate):  # type: ignore[misc]  # the base is untyped
        key = types.BaseNamedTuple

        def generic_resolve(self, typ: Any, name: str) -> Any:
            method = inspect.getattr_static(getattr(typ, "instance_class", None), name, None)
            if method not in _registered:
                return None

            class Call(AbstractTemplate):  # type: ignore[misc]  # the base is untyped
                key = _lowering_key(method)

                def generic(self, args: Any, kws: Any) -> Any:
                    function = self.context.resolve_value_type(method)
                    call_type = function.get_call_type(self.context, (typ, *args), kws)
                    return call_type.replace(pysig=inspect.signature(method)).as_method()

            return types.BoundFunction(Call, typ)

    infer_getattr(PlainMethods)


@cache
def _register_lowering(method: Callable[..., Any]) -> None:
    """A call of the method is a call of its plain function with the named tuple as first argument."""
    from numba import types
    from numba.extending import lower_builtin

    @lower_builtin(_lowering_key(method), types.BaseNamedTuple, types.VarArg(types.Any))  # type: ignore[untyped-decorator]
    def call(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        typing = context.typing_context
        function = typing.resolve_value_type(method)
        chosen = function.get_call_type(typing, signature.args, {})
        compiled = context.get_function(function, chosen)
        context.add_linking_libs(getattr(compiled, "libs", ()))
        return compiled(builder, args)


def _lowering_key(method: Callable[..., Any]) -> tuple[str, Callable[..., Any]]:
    return ("plain method", method)
