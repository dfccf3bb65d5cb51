"""Describes the outcome of a drive in one sentence."""

from roadgpt.drive import Drive
from roadgpt.verdict import Verdict

WENT_ON = {
    "goal": "then came to the goal",
    "fell": "then fell",
    "stuck": "then got stuck",
    "timeout": "then ran out of time",
}


def outcome_sentence(verdict: Verdict, drive: Drive) -> str:
    """Returns the verdict's sentence. If the car drove on after it left its lane, the sentence also says how
    the drive ended."""
    if verdict.cause != "out of lane" or drive.ended not in WENT_ON:
        return verdict.description
    return f"{verdict.description}, {WENT_ON[drive.ended]} after {drive['s'][-1]:.0f} m"
