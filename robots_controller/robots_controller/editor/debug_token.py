"""The token that an editor gives before it may debug."""

import secrets


def new_token() -> str:
    """Twelve characters that cannot be guessed."""
    return secrets.token_urlsafe(9)
