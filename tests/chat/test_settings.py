"""Flags before the environment before .env before TOML; each setting tells where it was found."""

import json
from pathlib import Path
from typing import Any

import pytest

from chat.conftest import KEY
from chat.stub_server import StubServer, says
from command_line import invoke
from roadgpt.chat import ChatError, ChatSettings, configured, open_chat
from roadgpt.chat.config import key_for, settings_with_origin
from roadgpt.chat.model import address_of
from roadgpt.errors import UsageError
from roadgpt.settings import user_file
from tables import rows


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def test_every_place_yields_to_those_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def found() -> tuple[Any, str]:
        return tuple(settings_with_origin(flags)["model"])  # type: ignore[return-value]

    flags: dict[str, Any] = {}
    assert found() == (None, "default")
    write(user_file(), '[chat]\nmodel = "of-user"')
    assert found() == ("of-user", f"{user_file()} [chat]")
    write(Path("roadgpt.toml"), '[chat]\nmodel = "of-folder"')
    assert found() == ("of-folder", "roadgpt.toml [chat]")
    write(Path(".env"), "ROADGPT_MODEL=of-dotenv\n")
    assert found() == ("of-dotenv", ".env (ROADGPT_MODEL)")
    monkeypatch.setenv("ROADGPT_MODEL", "of-environment")
    assert found() == ("of-environment", "environment (ROADGPT_MODEL)")
    flags["model"] = "of-flag"
    assert found() == ("of-flag", "--model")
    assert configured(flags).model == "of-flag"


def test_every_setting_can_be_set_in_every_place(monkeypatch: pytest.MonkeyPatch) -> None:
    other = {
        "provider": "mine", "model": "m", "base_url": "http://localhost:1/v1",
        "temperature": 0.5, "timeout": 9.0, "retries": 1, "max_completion": 99, "max_tokens": 1000,
        "max_cost": 1.5, "price": "1/2", "record": "r", "replay": "p", "rounds": 2,
    }  # fmt: skip
    assert {*other} == {*ChatSettings.model_fields}
    write(Path("roadgpt.toml"), "[chat]\n" + "\n".join(f"{k} = {json.dumps(v)}" for k, v in other.items()))
    assert configured() == ChatSettings(**other)
    Path("roadgpt.toml").unlink()
    for name, value in other.items():
        monkeypatch.setenv(f"ROADGPT_{name.upper()}", str(value))
    assert configured() == ChatSettings(**other)


def test_openai_variables_are_heeded_and_ours_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_BASE_URL", "http://one:1/v1")
    assert configured().base_url == "http://one:1/v1"
    monkeypatch.setenv("ROADGPT_BASE_URL", "http://two:2/v1/")
    assert configured().base_url == "http://two:2/v1"


def test_a_key_of_another_program_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("api_key", "sk-of-another-program")
    assert key_for(None) is None


@pytest.mark.parametrize(("line", "value"), rows(__file__, "lines_dotenv"))
def test_lines_of_dotenv(line: str, value: str | None) -> None:
    write(Path(".env"), f"OTHER=1\nnot a line\n{line}\n" if line[0] != "\ufeff" else f"{line}\n")
    assert configured().model == value
    assert not Path("pwned").exists()


@pytest.mark.parametrize(("text", "told"), rows(__file__, "file_cannot_told"))
def test_a_file_that_cannot_be_is_told_with_its_name(text: str, told: str) -> None:
    write(Path("roadgpt.toml"), text)
    with pytest.raises(UsageError, match=told):
        configured()
    result = invoke("config", "show")
    assert result.exit_code == 2
    assert "roadgpt.toml" in result.output
    assert "Traceback" not in result.output


@pytest.mark.parametrize("url", rows(__file__, "base_url_place"))
def test_a_base_url_is_a_place_and_holds_no_key(url: str) -> None:
    with pytest.raises(UsageError, match="base URL") as caught:
        configured({"base_url": url})
    assert "secret" not in str(caught.value)


def test_keys_come_from_the_same_places(monkeypatch: pytest.MonkeyPatch) -> None:
    assert key_for(None) is None
    write(user_file(), '[chat]\napi_key = "of-user-0123456789"')
    assert str(key_for(None).origin) == f"{user_file()} [chat]"  # type: ignore[union-attr]
    write(Path(".env"), "OPENAI_API_KEY=of-dotenv-0123456789")
    assert key_for(None).value == "of-dotenv-0123456789"  # type: ignore[union-attr]
    monkeypatch.setenv("OPENAI_API_KEY", "  of-environment-0123 \n")
    assert key_for(None).value == "of-environment-0123"  # type: ignore[union-attr]
    monkeypatch.setenv("ROADGPT_API_KEY", "ours-0123456789")
    assert key_for(None).value == "ours-0123456789"  # type: ignore[union-attr]


def test_azure_has_a_key_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "of-openai-0123456789")
    monkeypatch.setenv("AZURE_OPENAI_API_KEY", "of-azure-0123456789")
    assert key_for("https://me.openai.azure.com").value == "of-azure-0123456789"  # type: ignore[union-attr]
    assert key_for("https://api.openai.com/v1").value == "of-openai-0123456789"  # type: ignore[union-attr]


@pytest.mark.parametrize(("given", "place"), rows(__file__, "servers"))
def test_where_the_servers_are(given: str | None, place: str) -> None:
    assert address_of(given) == place


def test_openai_without_a_key_is_told_before_anything_is_sent() -> None:
    with pytest.raises(ChatError, match=r"no key for https://api.openai.com/v1; .* OPENAI_API_KEY"):
        open_chat(ChatSettings(model="gpt-5-mini"))


def test_the_command_shows_origins_and_masks_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    monkeypatch.setenv("ROADGPT_MODLE", "typo")
    write(Path("roadgpt.toml"), '[chat]\nmodel = "mine"')
    result = invoke("config", "show", "--origin", "--max-cost", "0.5")
    assert result.exit_code == 0
    lines = {line.split()[0]: line for line in result.stdout.splitlines()}
    assert lines["model"].split()[1:] == ["mine", "roadgpt.toml", "[chat]"]
    assert lines["max_cost"].split()[1:] == ["0.5", "--max-cost"]
    assert lines["api_key"].endswith(f"sk-... ({len(KEY)} letters)  environment (OPENAI_API_KEY)")
    assert "ROADGPT_MODLE in the environment is not a setting" in result.stderr
    write(Path(".env"), "ROADGPT_RETRY=1\nOTHER=2")
    assert "ROADGPT_RETRY in .env is not a setting" in invoke("config", "show").stderr
    assert KEY not in result.output
    told = json.loads(invoke("config", "show", "--json").stdout)
    assert told["model"] == "mine"
    assert told["timeout"] == 60.0
    assert KEY not in json.dumps(told)


def test_options_for_models_are_refused_where_none_is_asked() -> None:
    result = invoke("run", "| turns=1..", "--reader", "plan", "--max-cost", "1")
    assert result.exit_code == 2
    assert "--max-cost is for language models; give --reader chat as well" in result.stderr


def test_doctor_looks_for_the_model_that_is_named(stub: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    from roadgpt.chat.client import diagnose

    assert "none is needed" in diagnose()
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    assert "none is needed" in diagnose()  # a key alone is for other programs
    stub.play(says("{}"))
    monkeypatch.setenv("ROADGPT_BASE_URL", stub.url)
    assert f"any of 1 at {stub.url}, through openai 3" in diagnose()
    monkeypatch.setenv("ROADGPT_MODEL", "other")
    with pytest.raises(ChatError, match="has no model 'other'; it has stub-model"):
        diagnose()
    monkeypatch.setenv("ROADGPT_BASE_URL", "http://127.0.0.1:9/v1")
    with pytest.raises(ChatError, match="cannot be reached"):
        diagnose()


@pytest.mark.parametrize(
    "line", [(".env", "ROADGPT_BASE_URL={}"), ("roadgpt.toml", '[chat]\nbase_url = "{}"')]
)
def test_a_folder_does_not_get_the_users_key_sent_anywhere(
    line: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    url = "https://elsewhere.example/v1"
    write(Path(line[0]), line[1].format(url))
    assert key_for(configured().base_url) is None  # there is none that could go there
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    with pytest.raises(ChatError, match=f"named in {line[0]}") as caught:
        key_for(configured().base_url)
    assert KEY not in str(caught.value)
    monkeypatch.setenv("OPENAI_BASE_URL", url)
    assert key_for(url).value == KEY  # type: ignore[union-attr]


def test_a_folder_may_name_a_server_of_this_machine_or_bring_its_own_key(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    write(Path("roadgpt.toml"), '[chat]\nbase_url = "http://127.0.0.1:11434/v1"')
    assert key_for(configured().base_url).value == KEY  # type: ignore[union-attr]
    write(
        Path("roadgpt.toml"), '[chat]\nbase_url = "https://own.example/v1"\napi_key = "of-folder-0123456789"'
    )
    assert key_for(configured().base_url).value == "of-folder-0123456789"  # type: ignore[union-attr]
