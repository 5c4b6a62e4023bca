"""Types of the compiled module. tests/test_stubs.py compares this list with the module's exports."""

from typing import Any

__version__: str

def methods() -> list[dict[str, Any]]: ...
