"""The functions of robot programs as the reference writes them."""

from robots_controller.interpreter.functions.lua_function import LuaFunction


def signature(function: LuaFunction) -> str:
    """As in a program: name(arguments), those in brackets optional."""
    names = []
    for argument in function.arguments:
        name = argument.name
        if argument.per_axis or argument.repeated:
            name = f'{name}1, ..., {name}n'
        names.append(f'[{name}]' if argument.optional else name)
    names += ['[options]'] * bool(function.options) + ['...'] * function.more
    return f'{function.name}({", ".join(names)})'
