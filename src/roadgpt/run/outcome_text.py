"""Describes the outcome of a drive in one sentence, and adds how the drive ended if the car drove on after
it had left its lane."""

from roadgpt.drive import Drive
from roadgpt.verdict import Verdict

WENT_ON = {
    "goal": "then came to the goal",
    "fell": "then fell",
    "stuck": "then got stuck",
    "timeout": "then ran out of time",
}


def outcome_sentence(verdict: Verdict, drive: Drive) -> str:
    """Returns the verdict's sentence; if the car drove on after a lane departure, adds how its drive
    ended."""
    if verdict.cause != "out of lane" or drive.ended not in WENT_ON:
        return verdict.description
    return f"{verdict.description}, {WENT_ON[drive.ended]} after {drive['s'][-1]:.0f} m"
