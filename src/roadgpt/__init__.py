"""RoadGPT turns words into tested roads.

The public classes and functions are imported from here. Each is loaded when it is first used::

    import roadgpt

    brief = roadgpt.read("an uphill road with 3 turns")
    design = roadgpt.draft(brief, roadgpt.World(), seed=7)
    road = roadgpt.build(design)
"""

import sys
from importlib import import_module
from typing import Any

from roadgpt.later import load, names_of

__version__ = "0.1.0"

# Every public class and function, by the sub-package or module that defines it.
_OFFERED = {
    "brief": "Brief Outline outline read sentence",
    "road": "World Site CrossSection Limits Design Road build read_design",
    "network": "Network Route build_route read_map read_opendrive read_road read_source",
    "check": "Finding inspect",
    "design": "draft",
    "drive": "Drive simulate",
    "verdict": "Verdict judge",
    "run": "Run perform prove",
    "campaign": "campaign",
    "campaign.csv_tables": "to_frame",
    "report": "draw",
    "report.plotting": "plot",
    "report.similarity": "compare",
}
__all__ = ["__version__", *names_of(_OFFERED)]


def __getattr__(name: str) -> Any:
    return load(__name__, _OFFERED, name)


def __dir__() -> list[str]:
    return __all__


# Values that a notebook shows as pictures or as a sentence, by module and class. Nothing is imported before
# one is shown.
_PICTURES = (
    ("roadgpt.road.road", "Road"),
    ("roadgpt.road.design", "Design"),
    ("roadgpt.run.model", "Run"),
    ("roadgpt.campaign.run_folder", "Campaign"),
)
_SENTENCES = (("roadgpt.brief.model", "Brief"), ("roadgpt.verdict.verdict", "Verdict"))


def _picture(value: Any) -> Any:
    return import_module("roadgpt.report.plotting").png_of(value)


def _sentence(value: Any) -> str:
    if hasattr(value, "outcome"):
        return f"**{value.outcome}**: {value.description}"
    unused = ", ".join(f"'{word}'" for word in value.unused)
    told: str = import_module("roadgpt.brief").sentence(value)
    return f"{told} Not used: {unused}." if unused else told


def _show_values_in_notebooks() -> None:
    if "IPython" in sys.modules:
        shell = sys.modules["IPython"].get_ipython()
        if shell is not None:
            formatters = shell.display_formatter.formatters
            for module, name in _PICTURES:
                formatters["image/png"].for_type_by_name(module, name, _picture)
            for module, name in _SENTENCES:
                formatters["text/markdown"].for_type_by_name(module, name, _sentence)


_show_values_in_notebooks()
