"""A target: how an input is made from a number, and what is done with it."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError


@dataclass(frozen=True)
class Input:
    """A file that a target reads.

    Attributes:
        name: of the file, whose extension may count; a folder before it is made.
        data: its content.
    """

    name: str
    data: bytes


@dataclass(frozen=True)
class Target:
    """Something that reads what comes from outside.

    Attributes:
        name: as on the command line.
        make: random numbers -> an input.
        call: reads the file, and says in a word what became of it. An `InputError` is what it should raise for bad
            input; anything else is a failure.
        seeds: inputs that are good as they are; each must be read without an error.
        prepare: puts further files beside the input, once.
        end: ends the threads that it has begun, which may abort a program that leaves them behind.
    """

    name: str
    make: Callable[[np.random.Generator], Input]
    call: Callable[[Path], str]
    seeds: Callable[[], list[Input]]
    prepare: Callable[[Path], None] = lambda folder: None
    end: Callable[[], None] = lambda: None

    def input(self, seed: int, index: int) -> Input:
        """The input of a number; always the same."""
        return self.make(np.random.default_rng([seed, zlib.crc32(self.name.encode()), index]))


def put(made: Input, folder: Path) -> Path:
    """Write an input into a folder; what is given to the target is the file, or the folder that it names."""
    path = folder / made.name
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(made.data)
    return folder / Path(made.name).parts[0]


def judged(target: Target, path: Path) -> str:
    """Let the target read a file.

    Returns:
        What became of it: what `call` says, or "refused".

    Raises:
        AssertionError: it was refused otherwise than in one line that names the file.
        Exception: whatever was not foreseen.
    """
    try:
        return target.call(path)
    except InputError as error:
        message = str(error)
        assert message and message.isprintable(), f"not one line: {message!r}"
        assert path.name in message, f"does not name the file: {message}"
        return "refused"
