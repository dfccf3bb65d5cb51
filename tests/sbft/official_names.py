"""The public names of the SBFT tool competition's pipeline, as generators can import them.

Facts, read from its code of November 2024, and none of that code. Classes and functions are given with their
parameters, constants and attributes without; names that begin with an underscore are left out. Modules that
only drive BeamNG or a network are in ``ELSEWHERE``.
"""

from tables import rows

NAMES: dict[str, str] = dict(rows(__file__, "names"))
ELSEWHERE: list[str] = rows(__file__, "elsewhere")
