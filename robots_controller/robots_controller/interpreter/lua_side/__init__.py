"""The Lua side of the sandbox: what is built in Lua before a program runs."""
