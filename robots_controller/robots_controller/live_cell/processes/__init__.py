"""The processes of a live cell: forked from one server, watched, restarted, ended."""
