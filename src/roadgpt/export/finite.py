"""Numbers that a file can hold."""

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.geometry.curve import Array

NOT_FINITE = "the road has a number that is not finite; check it before it is exported"


def finite(values: Array) -> Array:
    """These very values.

    Raises:
        ExportError: one is not finite; readers of files know no such number.
    """
    if not np.isfinite(values).all():
        raise ExportError(NOT_FINITE)
    return values
