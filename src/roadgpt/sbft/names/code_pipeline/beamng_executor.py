"""The executor again, under the name of the one that drives in BeamNG."""

from roadgpt.sbft.executor import AbstractTestExecutor as BeamngExecutor

__all__ = ["BeamngExecutor"]
