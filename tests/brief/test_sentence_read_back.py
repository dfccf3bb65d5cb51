"""The sentence that a Brief says itself in is read back by the trained reader as the same requirements."""

from itertools import islice

from roadgpt.brief import normal, sentence
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.errors import BriefError
from roadgpt_training.generator import pairs

SHARE = 0.9
NUMBER = 60


def test_sentences_of_usual_briefs_are_read_back() -> None:
    reader, missed = ModelReader(), []
    plans = [pair.plan for pair in islice(pairs(2026), NUMBER) if not pair.plan.startswith("!")]
    for line in plans:
        wanted = normal(read_plan(line))
        try:
            got = normal(reader.read(sentence(wanted))).model_copy(update={"beside": ()})
        except BriefError as error:
            missed.append(f"{sentence(wanted)}: {error}")
            continue
        if got != wanted:
            missed.append(f"{sentence(wanted)}: {line}")
    assert len(missed) <= (1 - SHARE) * len(plans), "\n".join(missed)
