"""The standard form of a plan, which is the one that the model learns to write."""

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan


def standard(brief: Brief) -> str:
    """Returns the plan of a Brief's normal form."""
    return plan(normal(brief))
