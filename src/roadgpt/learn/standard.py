"""The one way in which we write a plan that could be written in several: what the model learns to write."""

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan


def standard(brief: Brief) -> str:
    """The plan of the normal form of a Brief."""
    return plan(normal(brief))
