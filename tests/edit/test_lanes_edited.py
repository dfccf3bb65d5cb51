"""Repairs and changes in a World with more lanes and banked bends."""

from roadgpt.brief import read
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.road import CrossSection, Design, Segment, World, build
from roadgpt_edit.editing import edit
from roadgpt_edit.onto_map import moved_onto_map

WORLD = World(section=CrossSection(lanes="3+2", lane_width=3.5, bank="auto"))


def test_a_change_of_a_banked_road_is_valid_and_changes_what_was_named() -> None:
    design = draft(read("turn x3", "plan"), WORLD, seed=4)
    edited = edit(design, read_change_plan("turn 1: angle more"), WORLD)
    assert inspect(WORLD.lay(build(edited.design)), None, WORLD) == ()
    changed = [a != b for a, b in zip(design.segments, edited.design.segments, strict=True)]
    assert sum(changed) >= 1


def test_a_road_whose_outer_lane_leaves_the_map_is_moved_in() -> None:
    segments = (Segment(distance=100, direction="straight"),)
    near = Design(starting_point=(20.0, 9.0, 0.0), theta=0.0, segments=segments)
    assert inspect(WORLD.lay(build(near)), None, WORLD)[0].rule == "inside_map"
    mended = moved_onto_map(near, WORLD)
    assert mended is not None
    assert inspect(WORLD.lay(build(mended)), None, WORLD) == ()
    assert mended.starting_point[1] >= 10.5
