"""Checks that numbers can be written to a file."""

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.geometry.curve import Array

NOT_FINITE = "the road has a number that is not finite; check it before it is exported"


def finite(values: Array) -> Array:
    """Returns these values unchanged.

    Raises:
        ExportError: A value is not finite. File formats have no such numbers.
    """
    if not np.isfinite(values).all():
        raise ExportError(NOT_FINITE)
    return values
