"""Interpreter of robot programs in Lua."""
