"""Looks whether the language model of the settings can be asked, for ``roadgpt doctor``."""

from importlib.metadata import PackageNotFoundError, version

from roadgpt.chat.config import DEFAULT, configured, gathered, key_for
from roadgpt.chat.fault import FaultError
from roadgpt.chat.place import place_of
from roadgpt.chat.strict import plain
from roadgpt.chat.wire import Wire
from roadgpt.errors import ChatError

PATIENCE = 5.0  # s


def looked() -> str:
    """What was found, in a sentence.

    Raises:
        ChatError: a model or a server is named that cannot be asked.
        UsageError: a setting cannot be.
    """
    found = gathered()
    if all(found[name].origin == DEFAULT for name in ("model", "base_url")):
        return "none is named, and none is needed; see roadgpt config show"
    try:
        library = f"openai {version('openai')}"
    except PackageNotFoundError:
        raise ChatError(
            "the package 'openai' is missing; say python -m pip install 'roadgpt[chat]'"
        ) from None
    settings = configured().model_copy(update={"timeout": PATIENCE, "retries": 0})
    place, wanted = place_of(settings.base_url), settings.model
    try:
        models = Wire(settings, key_for(settings.base_url)).models()
    except FaultError as fault:
        raise ChatError(fault.sentence) from None
    names = [str(one.get("id")) for one in models]
    if wanted and names and wanted not in names:
        shown = ", ".join(plain(name, 40) for name in names[:5])
        raise ChatError(f"{place} has no model '{plain(wanted)}'; it has {shown}")
    ends = next((one.get("shutdown_date") for one in models if one.get("id") == wanted), None)
    told = f"; it is switched off on {plain(str(ends), 20)}" if ends else ""
    return f"{wanted or 'any'} of {len(names)} at {place}, through {library}{told}"
