"""Converts a pydantic model to a flat JSON schema that uses only the keywords that all servers accept.

The schema consists of strings, numbers, booleans, null, enumerations, lists and objects. In an object, every
field is required, and no other fields are allowed. Patterns, lengths, numeric limits, defaults and tuples are
left out. Some servers ignore these keywords, some reject them, and some then ignore the whole schema. The
limits still hold, because every reply is validated against the pydantic model.
"""

from typing import Any

from pydantic import BaseModel, ConfigDict

KEPT = ("type", "enum", "const", "description")
MOST_DEPTH = 5  # OpenAI's limit on nesting


def fixed_description(text: str) -> ConfigDict:
    """Returns a pydantic configuration that makes ``text``, not the docstring, the description in a model's
    schema.

    A recorded answer is found by a hash of the question, and the question includes the schema. So the
    docstring of a model can be edited, but the description in its schema must stay the same.
    """
    return ConfigDict(json_schema_extra={"description": text})


def schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """Returns the flat JSON schema of a model. Raises TypeError if the model refers to itself or has objects
    without named fields (a bug in the caller).
    """
    whole = model.model_json_schema()
    return _flat(whole, whole.get("$defs", {}), 0)


def _flat(schema: dict[str, Any], named: dict[str, Any], depth: int) -> dict[str, Any]:
    if depth > 2 * MOST_DEPTH:
        raise TypeError("a schema that refers to itself cannot be sent to a language model")
    if "$ref" in schema:
        inner = _flat(named[schema["$ref"].rsplit("/", 1)[1]], named, depth + 1)
        return inner | {key: schema[key] for key in ("description",) if key in schema}
    if "allOf" in schema and len(schema["allOf"]) == 1:
        return _flat(schema["allOf"][0], named, depth + 1)
    either = schema.get("anyOf") or schema.get("oneOf")
    if either:
        return _either([_flat(one, named, depth + 1) for one in either], schema)
    flat = {key: schema[key] for key in KEPT if key in schema}
    if "const" in flat:
        flat = {"type": flat.get("type", "string"), "enum": [flat.pop("const")]} | flat
    if flat.get("type") == "object":
        fields = schema.get("properties", {})
        if not fields:
            raise TypeError("a schema for a language model needs named fields in every object")
        flat["properties"] = {name: _flat(field, named, depth + 1) for name, field in fields.items()}
        flat["required"] = list(fields)
        flat["additionalProperties"] = False
    elif flat.get("type") == "array":
        items = schema.get("items") or schema.get("prefixItems", [{"type": "string"}])[0]
        flat["items"] = _flat(items, named, depth + 1)
    return flat


def _either(branches: list[dict[str, Any]], schema: dict[str, Any]) -> dict[str, Any]:
    """Returns a union; a union of plain types becomes a list of types, which more servers accept."""
    told = {"description": schema["description"]} if "description" in schema else {}
    if all(set(branch) == {"type"} for branch in branches):
        kinds = [branch["type"] for branch in branches]
        return {"type": kinds[0] if len(kinds) == 1 else kinds} | told
    return {"anyOf": branches} | told
