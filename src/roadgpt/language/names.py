"""The names in the table, as types. Made by ``python -m roadgpt.language``."""

from typing import Literal

ActorKind = Literal[
    "car",
    "van",
    "truck",
    "bus",
    "motorcycle",
    "bicycle",
    "adult",
    "child",
    "animal",
    "cones",
    "barrier",
    "lost_load",
    "pickup",
    "suv",
    "police_car",
    "ambulance",
    "fire_engine",
    "tram",
    "e_scooter",
    "wheelchair_user",
    "person_with_pushchair",
    "dog",
    "deer",
    "tractor",
    "articulated_lorry",
]
Where = Literal[
    "ahead",
    "behind",
    "lane",
    "far",
    "oncoming",
    "crossing",
    "parked",
    "ramp",
    "junction",
    "crosswalk",
    "beside",
    "roundabout",
]
What = Literal[
    "keep",
    "brake",
    "stop",
    "speed",
    "follow",
    "open_gap",
    "swerve",
    "drift",
    "cut_in",
    "cut_out",
    "change_lane",
    "overtake",
    "merge",
    "pull_out",
    "turn_off",
    "turn_in",
    "turn_across",
    "cross",
    "run_light",
    "run_sign",
    "reverse",
    "wrong_way",
]
Flow = Literal[
    "light",
    "medium",
    "dense",
]
WeatherKind = Literal[
    "fog",
    "rain",
    "hail",
    "dust",
]
Light = Literal[
    "night",
    "low_sun",
]
Surface = Literal[
    "wet",
    "snow",
    "ice",
]
Landform = Literal[
    "valley",
    "ridge",
    "lake",
    "river",
    "coast",
    "forest",
    "town",
    "bridge",
    "tunnel",
    "cutting",
    "embankment",
    "tree_lined",
]
