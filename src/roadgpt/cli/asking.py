"""Asks at the terminal what a reading leaves in doubt, or open."""

import click

from roadgpt.brief import Brief, sentence
from roadgpt.brief.questions import questions

ENOUGH = {"exit", "quit", "bye", "q"}
HELP = {"help", "?", "hilfe"}
MOST_ASKED = 3


def asked(question: str, explained: str = "") -> str:
    """Returns the answer without blanks around it; explains, and asks again, if it asks for help. Raises
    EOFError if the user wants to leave."""
    while True:
        answer = input(question).strip()
        if answer.lower() in ENOUGH:
            raise EOFError
        if answer.lower() not in HELP or not explained:
            return answer
        click.echo(f"{explained}\n")


def made_clear(brief: Brief, of_numbers: bool = True, done: tuple[str, ...] = ()) -> Brief:
    """Returns the Brief that the answers to at most three questions choose; ``done`` are those before."""
    found = (each for each in questions(brief, of_numbers) if each[0] not in done)
    about, choices = next(found, ("", []))
    if not about or len(done) == MOST_ASKED:
        return brief
    was, *told = (sentence(each).removesuffix(".").split("; ") for each in (brief, *choices))
    news = ("; ".join(part for part in each if part not in was) for each in told)
    click.echo("\n  ".join([about, *(f"{n}  {said}" for n, said in enumerate(news, 1))]))
    numbered = {"": brief} | {str(n): each for n, each in enumerate(choices, 1)}
    while (answer := asked(f"1 to {len(choices)}, or Enter to leave it as it is> ")) not in numbered:
        pass
    return made_clear(numbered[answer], of_numbers, (*done, about))
