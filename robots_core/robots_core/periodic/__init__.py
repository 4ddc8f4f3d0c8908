"""Loops that keep time: schedules, real-time threads, watchdogs."""
