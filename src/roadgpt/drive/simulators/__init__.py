"""Simulator plug-ins: each defines a class with ``simulate(road, world, driver, seed, keep_driving)``."""
