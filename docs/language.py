"""Writes docs/reference/road-users.md from the table of the language, and docs/how-to/write-plans.md from
what agents are told of it."""

from pathlib import Path

from roadgpt.brief import read, sentence
from roadgpt.brief.readers.plan import PlanReader
from roadgpt.errors import BriefError
from roadgpt.language.table import MANEUVERS, NUMBERS, PLACES, ROAD_USERS, WEATHER, Words, one_of
from roadgpt_mcp.knowledge import DATA, topics

DOCS = Path(__file__).parent
WRONG = "turn left left 90; straight 40 && truck gap=30: brake 6; wet"
LANGUAGES = {"en": "English", "de": "German", "fr": "French", "es": "Spanish", "it": "Italian"}


def said(*lists: Words) -> str:
    """Returns the first words that mean a kind in each language."""
    found = [next((words[code] for words in lists if code in words), ()) for code in LANGUAGES]
    return ", ".join(dict.fromkeys(each[0][0].format("...") for each in found if each))


def road_users() -> str:
    """Returns the page of road users, places, maneuvers and weather."""
    out = [
        "# Road users, places, maneuvers and weather\n",
        "Written by `make docs` from the table of the language (`src/roadgpt/language/`), which says where "
        "the numbers come\nfrom, too. How they stand in a plan: [Scenes](plans.md#scenes). "
        "How a row is added: [Add a part](../how-to/add-a-part.md#a-road-user-or-weather).\n",
        "## Road users\n",
        "| kind | box (m) | speed (km/h) | read as | words |\n|---|---|---|---|---|",
    ]
    for kind, row in ROAD_USERS.items():
        box = " x ".join(f"{each:g}" for each in row.size)
        speed = f"{row.speed:g}" if row.speed else "" if row.group == "thing" else "the limit"
        words = said(row.words, row.unseen, row.also)
        out.append(f"| `{kind}` | {box} | {speed} | {f'`{row.read_as}`' if row.read_as else ''} | {words} |")
    out += [
        "\nWithout a speed somebody drives as fast as the tested car or the limit allows. The trained reader "
        "writes those that are not\n*read as* another kind; the others it names afterwards by their words.\n",
        "## Places\n",
        "| place | in words | side | who |\n|---|---|---|---|",
    ]
    groups = {len(ROAD_USERS): "all", len(PLACES["behind"].who): "who can move"}
    for where, place in PLACES.items():
        out.append(f"| `{where}` | {place.said} | {place.side} | {groups.get(len(place.who), 'vehicles')} |")
    out += [
        "\n## Maneuvers\n",
        "The last column says what the script takes of the tested car, where that "
        "[can be told to](../explanation/who-has-the-wheel.md) do it.\n",
        "| maneuver | in words | numbers | who begins with it | tested car |\n|---|---|---|---|---|",
    ]
    for what, maneuver in MANEUVERS.items():
        numbers = ", ".join(f"`{NUMBERS[name].key}`" for name in maneuver.numbers)
        starts = "everybody" if len(maneuver.starts) == len(PLACES) else ", ".join(maneuver.starts)
        starts = starts if maneuver.who else "the tested car alone"
        out.append(f"| `{what}` | {maneuver.said} | {numbers} | {starts} | {maneuver.hands} |")
    out += ["\n## Weather\n", "| weather | from | to | alone | friction | words |\n|---|---|---|---|---|---|"]
    for air, weather in WEATHER.items():
        unit = "mm/h" if weather.falls else "m of visual range"
        low, high = weather.usual
        words = said(weather.words, weather.unseen)
        ends = f"{weather.least:g} | {weather.most:g} {unit} | {low:g} to {high:g}"
        out.append(f"| `{air}` | {ends} | {f'as `{weather.surface}`' if weather.surface else ''} | {words} |")
    known = ", ".join(one_of(kind) for kind in ("tram", "articulated_lorry"))
    return "\n".join([*out, f"\nLong vehicles ({known}) are one stiff body each.\n"])


def plans() -> str:
    """Returns the page for people who write plans."""
    told = topics("commands")
    form, numbers = told["overview"].split("\n\n")[1:3]
    steps = told["checking"].partition("\n")[2].partition("\n\n")[0]
    try:
        PlanReader().read(WRONG)
    except BriefError as error:
        objections = f"roadgpt: {error}"
    out = [
        "# Write plans\n",
        "A plan leaves nothing to interpretation: RoadGPT builds what stands there, or says what it cannot. "
        "Written by `make docs`\nfrom what [agents](use-with-agents.md) are told. All words: "
        "[plans](../reference/plans.md), [road users, places, maneuvers and "
        "weather](../reference/road-users.md).\n\nA plan is one line:\n",
        f"{form}\n\n{numbers}\n",
        "## Texts with their plans\n",
        '`roadgpt run --plan "..." --driver robot` drives each as told; below stands how RoadGPT reads it.\n',
    ]
    for worked in DATA["worked"]:
        said = f"*{sentence(read(worked['plan'], 'plan', map_size=None))}* {worked['says']}"
        out.append(f"> {worked['text']}\n\n```plan\n{worked['plan']}\n```\n\n{said}\n")
    return "\n".join(
        [
            *out,
            "## Check a plan\n",
            "`--plan` is short for `--reader plan`, also in campaigns. All objections come at once:\n",
            f'```text\n$ roadgpt read --plan "{WRONG}"\n{objections}\n```\n\n{steps}\n',
            "## What no plan can say\n",
            "Leave it out and keep the text beside the plan; or take the nearest word that the test does not "
            "depend on (dusk: `low_sun` or\n`night`), name what is seen but not built in `beside(...)`, or "
            "[add a row](add-a-part.md#a-road-user-or-weather). "
            "Nothing is guessed: an unknown word is refused.\n",
        ]
    )


PAGES = {"reference/road-users.md": road_users, "how-to/write-plans.md": plans}

if __name__ == "__main__":
    for name, page in PAGES.items():
        (DOCS / name).write_text(page(), encoding="utf-8")
