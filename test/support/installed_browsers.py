"""The browser of this machine."""

import shutil

CHROMES = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')


def installed_browser() -> str:
    """The path of a Chromium; '' for none."""
    return next((path for name in CHROMES if (path := shutil.which(name))), '')
