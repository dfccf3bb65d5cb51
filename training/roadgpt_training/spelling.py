"""Writes whole numbers as words in five languages."""

from roadgpt.brief.readers.model.number_words import SMALL, SPANISH_HUNDREDS, below_hundred

THOUSAND = {"en": "thousand", "de": "tausend", "fr": "mille", "es": "mil", "it": "mille"}
HUNDRED = {"en": "hundred", "de": "hundert", "fr": "cent", "es": "cien", "it": "cento"}


def spell(number: int, language: str) -> str:
    """Returns a whole number from 0 to 9999 in words."""
    if number < 100:
        return below_hundred(number, language)
    is_thousand = number >= 1000
    many, rest = divmod(number, 1000 if is_thousand else 100)
    name, said = (THOUSAND if is_thousand else HUNDRED)[language], SMALL[language][many]
    behind = spell(rest, language) if rest else ""
    match language:
        case "de":
            return ("" if many == 1 else said) + name + behind
        case "it":
            head = name if many == 1 else said + ("mila" if is_thousand else name)
            return head + behind
        case "fr":
            name += "s" if not is_thousand and many > 1 and not rest else ""
            head = name if many == 1 else f"{said} {name}"
        case "es" if not is_thousand:
            head = SPANISH_HUNDREDS[many] if number != 100 else name
        case "es":
            head = name if many == 1 else f"{said} {name}"
        case _:
            head = f"{said} {name}" + (" and" if rest else "")
    return f"{head} {behind}".rstrip()
