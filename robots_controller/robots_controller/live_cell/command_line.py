"""The command `cell`: the server that its nodes are forked from loads while this process loads the rest."""

from robots_controller.live_cell import fork_server


def main() -> None:
    """Run from the command line."""
    fork_server.start()
    from robots_controller.live_cell.cell_command import main  # noqa: PLC0415  # loads beside the server

    main()
