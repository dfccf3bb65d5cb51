"""Keeps docs/house.md true: rooms and their budgets, order of imports, registered parts, light imports."""

import ast
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

from roadgpt import plugins

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "roadgpt"
ANNEXES = (
    "roadgpt_beamng",
    "roadgpt_edit",
    "roadgpt_film",
    "roadgpt_formats",
    "roadgpt_gym",
    "roadgpt_mcp",
    "roadgpt_sbft",
    "roadgpt_search",
    "roadgpt_study",
)
FEW = {
    "roadgpt_edit": 107,
    "roadgpt_film": 25,
    "roadgpt_formats": 150,
    "roadgpt_mcp": 28,
    "roadgpt_sbft": 58,
}  # names of roadgpt that each may import
HALLWAY = {
    "compiled", "errors", "later", "plugins", "plural", "provenance", "reading", "settings", "children",
    "stopping",
}  # fmt: skip
TELLING = (
    "import atexit, sys; from roadgpt.cli import main; "
    "atexit.register(lambda: print(*sys.modules, file=sys.stderr)); main()"
)
"""Runs a command, and then writes the names of all modules that it has loaded."""
HEAVY = ("numpy", "scipy", "numba", "matplotlib", "mujoco", "pydantic", "shapely", "rich")


def rooms() -> list[str]:
    """The rooms in the order of the plan in docs/house.md."""
    plan = (ROOT / "docs" / "house.md").read_text(encoding="utf-8").split("```")[1]
    return re.findall(r"^  (\w+)/", plan, flags=re.MULTILINE)


def sources() -> list[Path]:
    return sorted(SOURCE.rglob("*.py"))


def texts() -> list[Path]:
    """Every text that the project ships or is built from."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    names = listed.stdout.decode().split("\0") if listed.returncode == 0 else []
    found = [ROOT / name for name in names if name] or sources()
    return [path for path in found if path.suffix in {".py", ".md", ".toml", ".txt", ".yml", ".json", ""}]


def room_of(path: Path) -> str:
    inside = path.relative_to(SOURCE)
    return inside.parts[0].removesuffix(".py")


@cache
def parts_of(path: Path) -> list[ast.stmt]:
    """Imports, classes and functions of a file, wherever in it they stand, without their bodies."""
    kinds = ast.Import | ast.ImportFrom | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    every = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
    found = [node for node in every if isinstance(node, kinds)]
    for node in found:
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            node.body = []  # or the whole tree would be kept
    return found


@cache
def names_imported(path: Path) -> set[str]:
    """The full names that a file imports, wherever in the file it does so."""
    package = path.relative_to(SOURCE.parent).parent.parts
    found = set[str]()
    for node in parts_of(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            whole = ".".join((*base, *([node.module] if node.module else [])))
            found |= {f"{whole}.{alias.name}" for alias in node.names}
    return found


def imports_of(path: Path) -> set[str]:
    """Rooms (or hallway modules) of roadgpt that a file imports."""
    return {name.split(".")[1] for name in names_imported(path) if name.startswith("roadgpt.")}


Arrow = tuple[str, str]


def arrows(package: str) -> set[Arrow]:
    """Which module imports which, also where it does so late or for types alone. Those in a folder of names
    import each other as if it were their root."""
    paths = (SOURCE.parent / package).rglob("*.py")
    module_of = {".".join(path.relative_to(SOURCE.parent).with_suffix("").parts): path for path in paths}
    modules = {name.removesuffix(".__init__"): path for name, path in module_of.items()}
    starts = {".".join(name.split(".")[:3]) for name in modules}
    found = set[Arrow]()
    for module, path in modules.items():
        for name in names_imported(path):
            theirs = f"{package}.names.{name}"
            whole = theirs if ".".join(theirs.split(".")[:3]) in starts else name
            while whole and whole not in modules:
                whole = whole.rpartition(".")[0]
            found.add((module, whole))
    return {(one, other) for one, other in found if other not in ("", one)}


def beside(arrow: Arrow) -> Arrow | None:
    """The same arrow between the two modules or folders that lie beside each other; None within a folder."""
    one, other = (name.split(".") for name in arrow)
    depth = next((n for n, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), None)
    return None if depth is None else (".".join(one[: depth + 1]), ".".join(other[: depth + 1]))


def in_circles(of: set[Arrow]) -> set[Arrow]:
    """The arrows of circles, and those between two circles."""
    begins, ends = {one for one, _ in of}, {other for _, other in of}
    left = {(one, other) for one, other in of if one in ends and other in begins}
    return left if left == of else in_circles(left)


SOURCES = {room: list(paths) for room, paths in groupby(sorted(sources(), key=room_of), key=room_of)}
"""The files of each room."""


def test_the_plan_lists_exactly_the_rooms_that_exist() -> None:
    exist = {path.parent.name for path in SOURCE.glob("*/__init__.py")}
    assert set(rooms()) == exist
    assert {path.stem for path in SOURCE.glob("*.py")} == {"__init__", "__main__", *HALLWAY}


@pytest.mark.parametrize("room", SOURCES)
def test_a_room_uses_only_rooms_above_it(room: str) -> None:
    order = rooms()
    if room in HALLWAY:
        allowed = HALLWAY
    elif room in ("__init__", "__main__"):
        allowed = {*order, *HALLWAY}
    else:
        allowed = {*order[: order.index(room) + 1], *HALLWAY}
    for path in SOURCES[room]:
        # __version__ is a name of the package itself, open to all
        assert imports_of(path) - {"__version__"} <= allowed, path


@pytest.mark.parametrize("package", ["roadgpt", *ANNEXES])
def test_no_modules_and_no_folders_import_each_other_in_a_circle(package: str) -> None:
    every = arrows(package)
    assert not in_circles(every)
    assert not in_circles({found for arrow in every if (found := beside(arrow))})


@pytest.mark.parametrize("shelf", plugins.KINDS)
def test_every_registered_part_loads_and_every_part_file_is_registered(shelf: str) -> None:
    packages = {"roadgpt", *ANNEXES}
    every = entry_points(group=f"roadgpt.{shelf}")
    ours = {part.name: part for part in every if part.module.split(".")[0] in packages}
    assert ours, f"nothing on the shelf {shelf}"
    for name in ours:
        assert plugins.find(shelf, name).__doc__, f"the part {name} says nothing about itself"
    files = {
        path.stem
        for path in SOURCE.glob(f"*/{shelf}/*")
        if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    inside = {part.module.split(".")[3] for part in ours.values() if part.module[:8] == "roadgpt."}
    assert inside == files - {"__init__"}


def test_rooms_keep_within_their_budgets() -> None:
    """Every line of Python counts, also empty ones. The table of docs/house.md has each room's budget."""
    table = (ROOT / "docs" / "house.md").read_text(encoding="utf-8").split("## Budgets")[1].split("\n## ")[0]
    budgets = {
        room: int(lines.replace(",", ""))
        for room, lines in re.findall(r"^\| (\w+) \| ([\d,]+) \|$", table, re.M)
    }
    lines = dict.fromkeys([*rooms(), "hallway", *ANNEXES], 0)
    for room, paths in SOURCES.items():
        where = room if room in lines else "hallway"
        lines[where] += sum(path.read_text(encoding="utf-8").count("\n") for path in paths)
    for annex in ANNEXES:
        every = (SOURCE.parent / annex).rglob("*.py")
        lines[annex] = sum(path.read_text(encoding="utf-8").count("\n") for path in every)
    assert budgets.keys() == lines.keys()
    assert not {room: (number, budgets[room]) for room, number in lines.items() if number > budgets[room]}


@pytest.mark.parametrize("room", SOURCES)
def test_files_are_finished_and_well_named(room: str) -> None:
    for path in SOURCES[room]:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"\b(TODO|FIXME|XXX|NotImplementedError)\b", text), path
        assert not re.search(r"\beval\(|\bexec\(|except:", text), path
        names = {*path.relative_to(SOURCE).with_suffix("").parts}
        assert not {"utils", "util", "common", "helpers", "misc"} & names, path


def test_a_name_of_a_class_means_one_thing() -> None:
    files = sorted(SOURCE.parent.rglob("*.py"))
    where = [(part.name, path) for path in files for part in parts_of(path) if isinstance(part, ast.ClassDef)]
    twice = {name for name, count in Counter(name for name, _ in where).items() if count > 1}
    assert not [(name, str(path)) for name, path in where if name in twice]


def test_nothing_in_roadgpt_names_an_annex() -> None:
    assert {path.name for path in SOURCE.parent.iterdir() if (path / "__init__.py").is_file()} == {
        "roadgpt",
        *ANNEXES,
    }
    name = re.compile(rf"{'|'.join(ANNEXES)}|roadgpt_training")
    assert not [path for path in sources() if name.search(path.read_text(encoding="utf-8"))]


def test_annexes_use_only_what_the_python_page_lists() -> None:
    page = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    listed = {
        f"{module}.{name}"
        for module, names in re.findall(r"^- `(roadgpt[\w.]*)`: (.+)$", page, re.M)
        for name in re.findall(r"`(\w+)`", names)
    }
    used = {annex: set[str]() for annex in ANNEXES}
    for annex, names in used.items():
        for path in (SOURCE.parent / annex).rglob("*.py"):
            for node in parts_of(path):
                if isinstance(node, ast.ImportFrom) and re.match(r"roadgpt(\.|$)", node.module or ""):
                    names |= {f"{node.module}.{alias.name}" for alias in node.names}
                elif isinstance(node, ast.Import):
                    names |= {alias.name for alias in node.names if alias.name.startswith("roadgpt.")}
    assert set().union(*used.values()) == listed
    assert not {annex: len(used[annex]) for annex, most in FEW.items() if len(used[annex]) > most}


def test_benchmarks_import_only_what_is_there() -> None:
    """They are run by hand, so nothing else would tell that a name has moved away."""
    missing = [
        f"{path.name}: {part.module}.{name.name}"
        for path in [*ROOT.glob("benchmarks/*.py"), *ROOT.glob("training/benchmarks/*.py")]
        for part in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(part, ast.ImportFrom) and (part.module or "").startswith("roadgpt")
        for name in part.names
        if not offers(str(part.module), name.name)
    ]
    assert not missing


def test_every_benchmark_has_a_smallest_size() -> None:
    """Which `make bench SIZE=smallest` runs."""
    lines = (ROOT / "benchmarks" / "smallest.txt").read_text(encoding="utf-8").splitlines()
    named = [line.split()[0] for line in lines if not line.startswith("#")]
    assert named == sorted(path.name for path in ROOT.glob("benchmarks/bench_*.py"))


def offers(module: str, name: str) -> bool:
    found = import_module(module)
    return hasattr(found, name) or (hasattr(found, "__path__") and find_spec(f"{module}.{name}") is not None)


def test_no_text_names_a_place_on_one_machine() -> None:
    place = re.compile(r"/(?:work|home|root|Users)/\w+|[A-Z]:\\Users|pypi[\w.-]*\.(?:org|io)|index-url", re.I)
    telling = [
        f"{path.relative_to(ROOT)}: {found.group()}"
        for path in texts()
        if path != Path(__file__).resolve() and path.is_file()
        for found in place.finditer(path.read_text(encoding="utf-8", errors="replace"))
    ]
    assert not telling


def test_light_modules_import_nothing_heavy() -> None:
    modules = ["roadgpt", "roadgpt.plugins", "roadgpt.cli", "roadgpt.__main__"]
    modules += [point.module for point in entry_points(group="roadgpt.commands")]
    code = "import importlib, sys\nfor each in sys.argv[1:]:\n    importlib.import_module(each)\n"
    code += "    print(each, *{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code, *modules], capture_output=True, text=True, check=True)
    lines = [line.split() for line in done.stdout.splitlines()]
    assert [module for module, *_ in lines] == modules
    for module, *loaded in lines:
        assert "roadgpt" in loaded
        assert not {*HEAVY} & {*loaded}, module


def test_the_package_offers_every_value_and_verb_that_it_names() -> None:
    import roadgpt

    for name in roadgpt.__all__:
        assert getattr(roadgpt, name) is not None
    for room, names in roadgpt._OFFERED.items():  # a room that is loaded already would hide a wrong one
        assert all(hasattr(import_module(f"roadgpt.{room}"), name) for name in names.split())
    with pytest.raises(AttributeError, match="it offers Brief"):
        _ = roadgpt.gpt


@pytest.mark.parametrize("room", rooms())
def test_a_room_offers_every_name_that_it_lists(room: str) -> None:
    """Some rooms load a name only when it is first used, so that a misspelt one would not be noticed."""
    module = import_module(f"roadgpt.{room}")
    for name in getattr(module, "__all__", ()):
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError):
        _ = module.no_such_name


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["campaign", "-h"]])
def test_help_answers_at_once(words: list[str]) -> None:
    """What makes it slow is what it imports, and that is the same on every machine."""
    done = subprocess.run(
        [sys.executable, "-c", TELLING, *words], capture_output=True, text=True, check=False
    )
    assert "Usage: roadgpt" in done.stdout + done.stderr
    loaded = {*done.stderr.split()}
    assert "click" in loaded
    assert not {name for name in loaded if name.split(".")[0] in HEAVY}
    rooms_used = {name.split(".")[1] for name in loaded if name.startswith("roadgpt.")}
    assert rooms_used <= {"cli", *HALLWAY}


def test_a_plain_road_loads_only_what_it_needs(tmp_path: Path) -> None:
    """Neither networks, land, others on the road and scenarios, nor what other commands and options need."""
    words = ["run", "a road", "--seed", "1", "--out", str(tmp_path / "out")]
    done = subprocess.run([sys.executable, "-c", TELLING, *words], capture_output=True, text=True, check=True)
    loaded = {*done.stderr.splitlines()[-1].split()}
    assert {"roadgpt.drive.simulators.mujoco", "roadgpt.report.overview"} <= loaded
    others = {
        "brief.scenarios",
        "chat.config",
        "cli.junit",
        "cli.roads",
        "export",
        "ground.ground",
        "traffic",
    }
    others |= {f"network.{name}" for name in ("landscape", "lanes", "markings", "paved", "route", "source")}
    assert not {f"roadgpt.{name}" for name in others} & loaded
    assert len([name for name in loaded if name.startswith("roadgpt")]) <= 180


def test_the_pins_cover_every_dependency_and_name_no_place() -> None:
    pins = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    pinned = {re.sub(r"[-_.]+", "-", name).lower() for name in re.findall(r"^([\w.-]+)==[\w.]+$", pins, re.M)}
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    wanted = {re.sub(r"[-_.]+", "-", name).lower() for name in re.findall(r'"([\w-]+)>=[\d.]+"', project)}
    assert len(wanted) > 15
    assert wanted <= pinned
    assert "://" not in pins


def test_the_wheel_holds_the_package_its_types_its_parts_and_its_licence() -> None:
    """As the builder lists it; to compress the weights takes ten seconds."""
    wheel = WheelBuilder(str(ROOT))
    inside = {file.distribution_path for file in wheel.recurse_included_files()}
    files = {path for path in SOURCE.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert {f"roadgpt/{path.relative_to(SOURCE).as_posix()}" for path in files} <= inside
    assert "roadgpt/py.typed" in inside
    assert wheel.metadata.core.license_files == ["LICENSE"]
    assert {f"roadgpt.{shelf}" for shelf in plugins.KINDS} <= wheel.metadata.core.entry_points.keys()
    assert not {name.split("/")[0] for name in inside} & {"tests", "docs", "benchmarks"}
