"""The names in the table, as types. Made by ``python -m roadgpt.language``."""

from typing import Literal

# fmt: off
ActorKind = Literal["car", "van", "truck", "bus", "motorcycle", "bicycle", "adult", "child", "animal",
    "cones", "barrier", "lost_load", "pickup", "suv", "police_car", "ambulance", "fire_engine", "tram",
    "e_scooter", "wheelchair_user", "person_with_pushchair", "dog", "deer", "tractor", "articulated_lorry",
    "door"]
Where = Literal["ahead", "behind", "lane", "far", "oncoming", "crossing", "parked", "ramp", "junction",
    "crosswalk", "beside", "roundabout"]
What = Literal["keep", "brake", "stop", "speed", "follow", "open_gap", "swerve", "drift", "cut_in",
    "cut_out", "change_lane", "overtake", "merge", "pull_out", "turn_off", "turn_in", "turn_across", "cross",
    "run_light", "run_sign", "reverse", "wrong_way", "wait", "creep", "pass", "pull_over", "u_turn",
    "cut_corner", "release", "open_door", "drop"]
Flow = Literal["light", "medium", "dense"]
WeatherKind = Literal["fog", "rain", "hail", "dust"]
Light = Literal["night", "low_sun"]
Surface = Literal["wet", "snow", "ice"]
Landform = Literal["valley", "ridge", "lake", "river", "coast", "forest", "town", "bridge", "tunnel",
    "cutting", "embankment", "tree_lined"]
Kind = Literal["straight", "crest", "dip", "turn", "hairpin", "switchback", "u_turn", "s_bend", "chicane",
    "slalom", "serpentine", "zigzag", "winding"]
Sharpness = Literal["gentle", "sweeping", "sharp"]
Size = Literal["long", "short"]
Slope = Literal["up", "down", "flat", "nearly_flat", "gently_up", "gently_down", "steeply_up",
    "steeply_down"]
Bump = Literal["crest", "dip"]
JunctionKind = Literal["t_junction", "y_junction", "crossroads", "star", "roundabout", "turning_circle",
    "junction", "merge", "diverge", "lane_drop", "lane_gain", "lane_change", "crosswalk", "bus_bay"]
Control = Literal["priority", "yield", "stop", "lights", "none"]
IslandSize = Literal["mini", "normal", "large"]
Take = Literal["left", "right", "straight", "back", "sharp_left", "sharp_right", "slight_left",
    "slight_right", "ramp", "main"]
Side = Literal["left", "right"]
Way = Literal["left", "right", "straight"]
Surroundings = Literal["country", "urban", "residential", "mountain", "access"]
CentreLine = Literal["solid", "broken", "double", "none"]
Compass = Literal["west", "southwest", "south", "southeast", "east", "northeast", "north", "northwest"]
Shown = Literal["red", "yellow", "green"]
Face = Literal["front", "rear", "left", "right"]
Works = Literal["narrowed", "closed", "shoulder"]
PlainKind = Literal["t_junction", "y_junction", "crossroads", "star", "roundabout", "turning_circle"]
MapJunctionKind = Literal["t_junction", "y_junction", "crossroads", "star", "roundabout", "junction"]
RampKind = Literal["merge", "diverge"]
LaneKind = Literal["lane_drop", "lane_gain", "lane_change", "crosswalk", "bus_bay"]
