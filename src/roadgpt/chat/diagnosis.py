"""Checks whether the configured language model can be used, for ``roadgpt doctor``."""

from importlib.metadata import PackageNotFoundError, version

from roadgpt.chat.address import address_of
from roadgpt.chat.client import ApiClient
from roadgpt.chat.config import DEFAULT, configured, key_for, settings_with_origin
from roadgpt.chat.request_error import RequestError
from roadgpt.chat.strict_json import plain
from roadgpt.errors import ChatError

PATIENCE = 5.0  # s


def diagnose() -> str:
    """Returns a text that names the model, the server and the library, or says that no model is configured.

    Raises:
        ChatError: a model or a server is configured but cannot be asked.
        UsageError: a setting is not valid.
    """
    found = settings_with_origin()
    if all(found[name].origin == DEFAULT for name in ("model", "base_url")):
        return "none is configured, and none is needed; see roadgpt config show"
    try:
        library = f"openai {version('openai')}"
    except PackageNotFoundError:
        raise ChatError(
            "the package 'openai' is missing; install it with: python -m pip install 'roadgpt[chat]'"
        ) from None
    settings = configured().model_copy(update={"timeout": PATIENCE, "retries": 0})
    place, wanted = address_of(settings.base_url), settings.model
    try:
        models = ApiClient(settings, key_for(settings.base_url)).models()
    except RequestError as fault:
        raise ChatError(fault.sentence) from None
    names = [str(one.get("id")) for one in models]
    if wanted and names and wanted not in names:
        shown = ", ".join(plain(name, 40) for name in names[:5])
        raise ChatError(f"{place} has no model '{plain(wanted)}'; it has {shown}")
    ends = next((one.get("shutdown_date") for one in models if one.get("id") == wanted), None)
    told = f"; it will be switched off on {plain(str(ends), 20)}" if ends else ""
    return f"{wanted or 'any'} of {len(names)} at {place}, through {library}{told}"
