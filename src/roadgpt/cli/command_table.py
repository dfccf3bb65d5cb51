"""Lists the commands under the headings of the help, and the earlier names of renamed commands and options,
which still work.
"""

from collections.abc import Sequence

# The help line of each command is here, so that `roadgpt --help` need not import the commands.
HEADINGS = {
    "Make": {
        "run": "Make roads from a description: design, check, drive and judge them.",
        "read": "Show how RoadGPT interprets a description, and how confident it is.",
        "edit": "Change a road with a request in plain words.",
        "drive": "Drive roads from files, or repeat tests of a campaign.",
    },
    "Look": {
        "show": "Summarise a run, a folder of runs or a campaign; watch a campaign.",
        "view": "View a road in 3-D with a replay of its drive, or draw pictures.",
        "film": "Film drives: from behind the car, from its hood, or two side by side.",
        "compare": "Measure how similar two roads are, and draw both.",
    },
    "Search": {
        "campaign": "Search for failures, or make thousands of roads, with parallel workers.",
        "resume": "Continue a campaign or a run that was interrupted.",
        "faults": "Group failures into distinct faults, and find why each occurs.",
    },
    "Evaluate": {
        "check": "Check roads against the rules.",
        "report": "Write a report on a folder of runs, a campaign or a study.",
        "study": "Repeat the evaluation of RoadGPT's thesis, or survey people.",
    },
    "Exchange": {
        "export": "Write roads for other tools: OpenDRIVE, OpenSCENARIO and others.",
        "import": "Read a road from an OpenDRIVE file.",
        "compete": "Run SBFT test generators, or the server of the SDC competition.",
    },
    "Set up": {
        "config": "Show all settings and where each comes from; list plug-ins.",
        "doctor": "Check this installation, or an installed BeamNG.tech.",
        "learn": "Train, evaluate and export your own model that reads descriptions.",
    },
}

COMMANDS = {name: line for commands in HEADINGS.values() for name, line in commands.items()}


EARLIER = {
    ("status",): (("show", "--progress"), "show CAMPAIGN"),
    ("top",): (("show", "--watch"), "show --watch CAMPAIGN"),
    ("plot",): (("view", "--format", "png"), "view --format png ROAD"),
    ("redrive",): (("drive", "--again"), "drive --again CAMPAIGN TEST"),
    ("parts",): (("config", "plugins"), "config plugins"),
    ("beamng", "selftest"): (("doctor", "beamng"), "doctor beamng"),
    ("beamng",): (("doctor", "beamng", "--help"), "doctor beamng"),
    ("sbft",): (("compete", "sbft"), "compete sbft"),
    ("sdc", "serve"): (("compete", "sdc"), "compete sdc"),
    ("sdc",): (("compete", "sdc", "--help"), "compete sdc"),
}
"""Maps the words of an earlier command to two things: the present words, and a text that shows the present
command to the user.
"""

EARLIER_OPTIONS = {"--verge": "--shoulder"}
EARLIER_VALUES = {"--view bonnet": "--view hood"}


def renamed(args: Sequence[str]) -> tuple[list[str], str]:
    """Returns the arguments after ``roadgpt``, with an earlier command name replaced by the present name, and
    a sentence that tells the user the present name; the sentence is empty if nothing was replaced.
    """
    for words, (new, shown) in EARLIER.items():
        if tuple(args[: len(words)]) == words:
            told = f"'roadgpt {' '.join(words)}' is now 'roadgpt {shown}'"
            return [*new, *args[len(words) :]], told
    return [*args], ""


def renamed_options(args: Sequence[str], known: Sequence[str]) -> tuple[list[str], list[str]]:
    """Returns the arguments after a command, with earlier names of options replaced by present names, and a
    sentence for the user about each replaced name. ``known`` are the option names that the command has now.
    """
    new: list[str] = []
    told: list[str] = []
    for place, word in enumerate(args):
        if word == "--":
            return [*new, *args[place:]], told
        name, equals, value = word.partition("=")
        now = EARLIER_OPTIONS.get(name, name)
        if now != name and now in known:
            told.append(f"'{name}' is now '{now}'")
            word = f"{now}{equals}{value}"
        new.append(word)
    return new, told
