"""The room of campaigns: thousands of tests, searched for, shared among workers, and never lost.

    Plan --cells--> Cell --ask--> Proposals --workers--> Results --tell--> the cell's generator
                                                            |
                                                        Store (one file)

Two shelves. ``generators/`` think out tests; ``executors/`` are the workers that drive them.
"""

from roadgpt.campaign.model import Budget, Cell, Generator, Goal, Pool, Proposal, Result

__all__ = ["Budget", "Cell", "Generator", "Goal", "Pool", "Proposal", "Result"]
