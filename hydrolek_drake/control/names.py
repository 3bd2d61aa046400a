"""Controllers by name, apart from what builds them, so that a command line is checked at once."""

from collections.abc import Iterable

from hydrolek_drake.errors import InputError

TITLES = {
    "pi": "PI, scaled input",
    "pid": "PID, scaled input",
    "pip_no_scaling": "PIP, no scaling",
    "pip_scaled": "PIP, scaled input",
    "pip_idz_a": "PIP IDZ a",
    "pip_idz_b": "PIP IDZ b",
    "pip_idz_c": "PIP IDZ c",
    "pip_forward_a": "PIP IDZ FP a",
    "pip_forward_b": "PIP IDZ FP b",
    "pip_forward_c": "PIP IDZ FP c",
    "fuzzy_single": "fuzzy, error",
    "fuzzy_double": "fuzzy, error and change",
    "fuzzy_double_printed": "fuzzy, Table 7.1",
    "fuzzy_appendix_f": "fuzzy, appendix F",
    "feedforward": "feedforward, learning",
}
"""Name -> how tables call it."""


def check_names(controllers: Iterable[str]) -> None:
    """Refuse unknown controllers.

    Raises:
        InputError: names the choices.
    """
    for name in controllers:
        if name not in TITLES:
            raise InputError(f"no controller '{name}'; choose {', '.join(TITLES)}")
