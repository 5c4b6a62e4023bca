"""navbound: how wrong an aircraft's position may be, and when that is not good enough."""

from navbound._core import __version__
from navbound.errors import FormatError, InputError, NavboundError

__all__ = ["FormatError", "InputError", "NavboundError", "__version__"]
