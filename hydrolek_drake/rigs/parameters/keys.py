"""Which keys a mapping in a file may have."""

import difflib
from collections.abc import Mapping
from typing import Any

from hydrolek_drake.errors import InputError


def refuse_unknown(raw: Any, allowed: tuple[str, ...], where: str) -> None:
    """Refuse what is not a mapping or has other keys than `allowed`.

    Raises:
        InputError: naming the key and the nearest allowed one.
    """
    if not isinstance(raw, Mapping):
        raise InputError(f"{where} must be a mapping with {', '.join(allowed)}")
    for key in raw:
        if key not in allowed:
            near = difflib.get_close_matches(str(key), allowed, n=1)
            hint = f" (did you mean {near[0]}?)" if near else ""
            raise InputError(f"{where}.{key}: unknown key{hint}; there are {', '.join(allowed)}")
