"""Writes docs/reference/road-users.md from the table of the language."""

from pathlib import Path

from roadgpt.language.table import MANEUVERS, NUMBERS, PLACES, ROAD_USERS, WEATHER, Words, one_of

PAGE = Path(__file__).parent / "reference" / "road-users.md"
LANGUAGES = {"en": "English", "de": "German", "fr": "French", "es": "Spanish", "it": "Italian"}


def said(*lists: Words) -> str:
    """Returns the first words that mean a kind in each language."""
    found = [next((words[code] for words in lists if code in words), ()) for code in LANGUAGES]
    return ", ".join(dict.fromkeys(each[0][0].format("...") for each in found if each))


def page() -> str:
    """Returns the whole page."""
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


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
