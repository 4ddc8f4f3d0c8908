"""ControllerRequest: what a program may ask the controller for."""

from typing import Literal

ControllerRequest = Literal['pause', 'resume', 'cancel']
