"""Studies: a program simulated over a grid of robots, drives, speeds and parameters, as one table."""

from robots_controller.study.run_study import run_study
from robots_controller.study.study_file import Study, read_study

__all__ = ['Study', 'read_study', 'run_study']
