"""The standard form of plans, in which all training data is written."""

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan


def standard(brief: Brief) -> str:
    """Brings a Brief into normal form and returns its plan."""
    return plan(normal(brief))
