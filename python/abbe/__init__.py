"""abbe: the geometric errors of machine tools, measured, mapped and explained.

Lengths are in m, angles in rad unless a name ends in another unit; arrays are float64, one row a point or pose.
Failures are InputError, DeviceError or NumericalError; the text says what happened, where, and what to do next.
"""
from ._abbe import *  # noqa: F401,F403
from ._abbe import __version__  # noqa: F401
