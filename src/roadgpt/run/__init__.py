"""Runs the pipeline from a description in words to a verdict. Main functions: ``perform`` and ``prove``.

    words --read--> Brief --draft--> Design --build--> Road --inspect--> Findings --simulate--> Drive
                               ^                                  |        (none)                 |
                               '----------- their sentences ------'                  Verdict <--judge

``perform`` makes a Run from words, and ``prove`` makes a Run from an existing Design or Road. ``drafted`` and
``driven`` are the two halves of ``perform``.
"""

import time
import traceback
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt import plugins
from roadgpt.brief import NoRoomError, read
from roadgpt.brief.model import Brief
from roadgpt.brief.scene import ACCELERATES, LEAVES
from roadgpt.brief.scene_fit import fitted
from roadgpt.chat import Meter, ReplyError, counting
from roadgpt.check import inspect, rules_of
from roadgpt.design import check_designer, designer_of
from roadgpt.design.road_search import failed_trial
from roadgpt.design.room import world_for
from roadgpt.drive import Drive, refuse_ignored, simulate
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.loading import require_permission
from roadgpt.errors import BriefError, DesignError, PartError, RoadGPTError, SceneError, SimulatorError
from roadgpt.network import made_from, refuse_without_route
from roadgpt.road import Design, Geometry, Road, World, in_short_segments
from roadgpt.run.folder import Draw, read_run, write_run
from roadgpt.run.model import Outcome, Request, Run, Seconds, Setup, seed_of
from roadgpt.run.versions import versions_of
from roadgpt.stopping import look
from roadgpt.verdict import Verdict, judge

if TYPE_CHECKING:
    from roadgpt.traffic.recording import Recording

__all__ = [
    "REFUSED",
    "Draw",
    "Outcome",
    "Request",
    "Run",
    "Seconds",
    "Setup",
    "brief_of",
    "check_parts",
    "drafted",
    "driven",
    "judged",
    "perform",
    "prove",
    "read_run",
    "recording_of",
    "seed_of",
    "write_run",
]

USUAL = World()
PLAIN = Setup()
MOST_ROUNDS = 3  # drafts of one road; a designer whose last draft still breaks a rule will not improve
REFUSED = "refused: "  # what the description of a test begins with whose scene cannot be on its road
WENT_ON = {
    "goal": "then came to the goal",
    "over": "then drove on to the end of the event",
    "fell": "then fell",
    "rolled": "then rolled over beside the road",
    "crashed": "then crashed beside the road",
    "sank": "then drove into water",
    "stuck": "then got stuck",
    "timeout": "then ran out of time",
}


def perform(
    words: str | Brief,
    seed: int = 0,
    world: World = USUAL,
    setup: Setup = PLAIN,
    index: int = 1,
    earlier: Sequence[Design] = (),
    meter: Meter | None = None,
) -> Run:
    """Makes a Run from words: reads them, designs a road in one or more drafts, drives it if it breaks no
    rule, and judges the drive.

    Args:
        words: a description, or the Brief that was read from it.
        seed: seed of the campaign; the road's own seed is derived from this seed and the road's index.
        world: the World, with the size of the map, the limits that the rules check, and the friction. If the
            World gives no friction, a surface that the words name, such as a wet road, determines it.
        setup: the Setup, which names the reader, designer, rules, simulator and driver.
        index: number of the road in its campaign, from 1.
        earlier: designs of earlier roads, from which the new design has to differ.
        meter: counts the calls, tokens and cost of language models, and holds the campaign's limits for them.

    Raises:
        BriefError: the words cannot be read.
        DesignError: nothing could be designed.
        ChatError: a language model could not be reached, or gave no usable answer.
        UsageError: a plug-in is not installed, the driver's file does not define a driver, or the simulator
            cannot apply a setting of the world.
        DriverError: the driver hung while it was created."""
    return driven(drafted(words, seed, world, setup, index, earlier, meter))


def drafted(
    words: str | Brief, seed: int, world: World, setup: Setup, index: int,
    earlier: Sequence[Design] = (), meter: Meter | None = None,
) -> Run:  # fmt: skip
    """Returns the Run of ``perform`` before it is driven."""
    check_parts(setup, world)
    begun = time.perf_counter()
    meter = meter or Meter.of(setup.chat)
    before = meter.spent
    brief = words if isinstance(words, Brief) else brief_of(words, world, setup, meter)
    world = world_for(brief, setup.staged(world, brief.left_hand))
    request = Request(words=brief.words, seed=seed, world=world, setup=setup)
    found = request.world
    brief = fitted(brief, found.scene, found.limits.speed_limit, found.given_map)
    check_parts(setup, request.world)
    own = seed_of(seed, index)
    with counting(meter, f"road {index}"):
        run = _designed(Run(request, index, own, brief=brief), brief, earlier)
    seconds, spent = Seconds(time.perf_counter() - begun), meter.spent.since(before)
    return replace(run, spent=spent if spent.calls else None, seconds=seconds)


def brief_of(words: str, world: World = USUAL, setup: Setup = PLAIN, meter: Meter | None = None) -> Brief:
    """Returns the Brief that the setup's reader reads from the words. The Brief is checked against the size
    of the world's map and the world's other limits. What the test robot shows to be impossible, or not to
    happen, goes back to a reader that asks a language model."""
    with counting(meter or Meter.of(setup.chat), "reading"):
        try:
            limits = (world.site.map_size, world.limits.min_radius, world.limits.max_grade)
            fixed, width = world.given_map is not None, world.section.road_width
            trial = partial(_failing, world=world, drives=setup.drives)
            return read(words, setup.reader, *limits, setup.chat, width, fixed, trial)
        except NoRoomError as error:
            from roadgpt.design.advice import no_room

            raise BriefError(no_room(error, world, failed_trial)) from error


def _failing(brief: Brief, world: World, drives: bool) -> tuple[str, ...]:
    """Returns in a sentence why a test of a Brief cannot be, or what of it does not happen with the test
    robot, who does not react; nothing if it happens as told. It never depends on the driver under test."""
    try:
        run = perform(brief, 0, world, Setup(driver="robot", drives=drives))
    except RoadGPTError as error:
        return (str(error),)
    is_told = run.outcome not in ("INVALID", "NOT TESTED", "ERROR")
    return () if is_told else (f"built and driven by a robot: {run.description.removeprefix(REFUSED)}",)


def prove(
    blueprint: Design | Road,
    seed: int = 0,
    world: World = USUAL,
    setup: Setup = PLAIN,
    index: int = 1,
    brief: Brief | None = None,
    despite_findings: bool = False,
) -> Run:
    """Makes a Run from a design or a Road: checks the road, drives it, and judges the drive.

    Args:
        blueprint: the Design, with or without junctions, or the Road.
        seed: seed of the drive; it is used unchanged.
        world: the World, with the size of the map, the limits that the rules check, and the friction. If the
            World gives no friction, a surface that ``brief`` names determines it.
        setup: the Setup, which names the rules, simulator and driver.
        index: number of the road in its campaign, from 1.
        brief: the requirements that the road has to meet; None if there are no requirements.
        despite_findings: whether to drive a road that breaks rules, as roads of real maps often do. The Run
            then has both the findings and the verdict. A road that is physically impossible to drive is never
            driven."""
    design, drawn = (None, blueprint.profile) if isinstance(blueprint, Road) else (blueprint, blueprint)
    world = setup.staged(world, bool(drawn and drawn.left_hand)).in_scene_of(brief).on_surface_of(brief)
    check_parts(setup, world)
    begun = time.perf_counter()
    road = made_from(blueprint, world, setup.geometry)
    if setup.drives:
        refuse_without_route(road, "driven")
    findings = inspect(road, brief, world, setup.rules)
    request = Request(words=brief.words if brief else "", seed=seed, world=world, setup=setup)
    checking = time.perf_counter() - begun
    run = Run(request, index, seed, brief=brief, design=design, road=road, findings=findings)
    return driven(replace(run, seconds=Seconds(checking)), despite_findings)


@cache
def check_parts(setup: Setup, world: World = USUAL) -> None:
    """Checks that the rules, the simulator and the driver can be loaded, before the first road is made."""
    rules_of(setup.rules)
    if setup.drives:
        refuse_ignored(plugins.find("simulators", setup.simulator), world, replays=bool(setup.tracks))
        driver_of(setup.driver)
        recording_of(setup)


def recording_of(setup: Setup) -> "Recording | None":
    """Returns the recorded tracks of others that a Setup names; None if there are none."""
    if not (setup.drives and setup.tracks):
        return None
    from roadgpt.traffic.recording import read_recording  # drives without others do not need it

    require_permission(setup.tracks)
    return read_recording(Path(setup.tracks))


def _designed(run: Run, brief: Brief, earlier: Sequence[Design]) -> Run:
    """Returns the Run with the first draft that breaks no rule; if every draft breaks one, the last draft."""
    world, setup = run.world, run.request.setup
    designer = designer_of(setup.designer, setup.chat)
    check_designer(designer, brief)
    own_geometry: Geometry | None = getattr(designer, "geometry", None)
    notes: tuple[str, ...] = ()
    for attempt in range(MOST_ROUNDS if getattr(designer, "redrafts", True) else 1):
        look()
        try:
            # another seed each time, so that a designer that does not read notes draws anew
            design = designer.draft(brief, world, notes, earlier, run.seed + attempt)
        except (DesignError, ReplyError):
            if run.road is None:
                raise
            break
        if setup.geometry == "spline" and own_geometry is None and design.is_plain:
            # designers draw bends, which a spline keeps only through many nodes
            design = in_short_segments(design)
        road = made_from(design, world, own_geometry or setup.geometry)
        findings = inspect(road, brief, world, setup.rules)
        run = replace(
            run,
            design=design,
            road=road,
            findings=findings,
            rounds=attempt + 1,
            designing=getattr(designer, "report", None),
        )
        if not findings and _is_staged(run):
            break
        notes = tuple(finding.sentence for finding in findings)
    return run


def _is_staged(run: Run) -> bool:
    """Returns whether the others of the scene can be, and act, on the road of a Run."""
    if run.road is None or not run.world.scene.has_others:
        return True
    from roadgpt.traffic import begin  # roads without others do not need it

    try:
        begin(run.road, run.world, run.seed, aims={})  # who is to hit somebody is aimed once, for the drive
    except Exception as error:  # what else goes wrong is told when the road is driven
        return not isinstance(error, SceneError)
    return True


def driven(run: Run, despite_findings: bool = False) -> Run:
    """Returns the Run after its drive, with its verdict; without a drive, if there is no road or it breaks a
    rule."""
    setup = run.request.setup
    run = replace(run, versions=versions_of([setup]))
    objections = [finding for finding in run.findings if finding.stops or not despite_findings]
    if objections:
        return replace(run, outcome="INVALID", description=objections[0].sentence)
    if run.road is None or not setup.drives:
        return run
    begun, driver = time.perf_counter(), None
    try:
        driver = driver_of(setup.driver)  # a new driver for each road, so that nothing carries over
        if setup.scenario:
            _refuse_beyond_grip(run.road, run.world, run.seed)
        recording = recording_of(setup)
        tracks = None if recording is None else recording.on(run.road, run.world)
        drive = simulate(run.road, run.world, driver, run.seed, setup.simulator, setup.keep_driving, tracks)
        run = judged(replace(run, drive=drive))
    except PartError:
        raise
    except SceneError as error:
        run = replace(run, outcome="INVALID", description=f"{REFUSED}{error}")
    except Exception as error:  # whatever a driver or a simulator raises costs this road, not the campaign
        said = str(error) if isinstance(error, RoadGPTError) else f"the simulation failed: {error!r}"
        is_lost = isinstance(error, SimulatorError)
        run = replace(run, outcome="ERROR", description=said, trace=traceback.format_exc(), is_lost=is_lost)
    return replace(
        run,
        versions=versions_of([setup], driver),
        driver_files=getattr(driver, "all_files", dict)(),
        seconds=replace(run.seconds, drive=time.perf_counter() - begun),
    )


def _refuse_beyond_grip(road: Road, world: World, seed: int) -> None:
    """Raises SceneError if a scene prescribes accelerations that the road does not give."""
    actions = [action for actor in world.scene.actors for action in actor.actions]
    if not any(each.what in LEAVES or ACCELERATES & each.model_fields_set for each in actions):
        return
    from roadgpt.traffic.rehearsal import rehearsed  # drives without others do not need it

    others = rehearsed(road, world, seed)
    beyond = [said for said, is_prescribed in others.limited.items() if is_prescribed] if others else []
    if beyond:
        raise SceneError(f"the scenario prescribes more than the road gives: {' and '.join(beyond)}")


def judged(run: Run) -> Run:
    """Returns a Run that has a road and a drive with the verdict of today's rules."""
    assert run.road is not None
    assert run.drive is not None
    verdict = judge(run.road, run.drive, run.world)
    return replace(run, outcome=verdict.outcome, description=_sentence(verdict, run.drive), verdict=verdict)


def _sentence(verdict: Verdict, drive: Drive) -> str:
    """Returns the verdict's sentence, and how the drive ended if the car drove on outside its lane."""
    if verdict.cause != "out of lane" or drive.ended not in WENT_ON:
        return verdict.description
    return f"{verdict.description}, {WENT_ON[drive.ended]} after {drive['s'][-1]:.0f} m"
