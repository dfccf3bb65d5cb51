"""Checks that numbers to be exported are finite."""

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.geometry.curve import Array

NOT_FINITE = "the road has a number that is not finite; check it before it is exported"


def finite(values: Array) -> Array:
    """Returns the values unchanged if all of them are finite.

    Raises:
        ExportError: A value is infinite or not a number, which file formats cannot represent.
    """
    if not np.isfinite(values).all():
        raise ExportError(NOT_FINITE)
    return values
