"""What the default installation does without: whole campaigns run where these packages cannot be imported."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WITHOUT = {"ribs", "pandas", "sklearn", "joblib"}


def _run(part: ast.AST) -> Iterator[ast.AST]:
    """The parts of a module but for those that only a check of types reads."""
    yield part
    for child in ast.iter_child_nodes(part):
        is_for_types = isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING"
        yield from () if is_for_types else _run(child)


def test_nothing_imports_them() -> None:
    found = set()
    for path in (*(ROOT / "src/roadgpt").rglob("*.py"), *(ROOT / "src/roadgpt_search").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if path.name != "surrogate.py" and not any(name in text for name in WITHOUT):
            continue  # to parse every file takes seconds
        for node in _run(ast.parse(text)):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            found |= {(path.name, name.partition(".")[0]) for name in names}
    assert not {(file, name) for file, name in found if name in WITHOUT}
    assert ("surrogate.py", "numpy") in found


def test_the_project_does_not_ask_for_them() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = " ".join(project["dependencies"]).lower().replace("scikit-learn", "sklearn")
    assert not {name for name in WITHOUT if name in wanted}
    assert "ribs" in " ".join(project["optional-dependencies"]["test"])
