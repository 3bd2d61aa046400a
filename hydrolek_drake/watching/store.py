"""What a watch has seen: one small file a recording, each whole or not there, from which the table is made.

A process that is killed at any moment loses the recording at hand; all that is written is derived from the content of
recordings, so that the table ends the same whenever and however often a watch was interrupted.
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import read_kept, results_folder, write_whole
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.asking import Answer, EffectTold
from hydrolek_drake.watching.reference import Posterior
from hydrolek_drake.watching.settings import METHOD
from hydrolek_drake.watching.stamps import Stamp

SEEN, REFERENCE = "seen", "reference.json"


@dataclass(frozen=True)
class Seen:
    """One recording that was looked at.

    Attributes:
        recording: its path as it was given.
        digest: hash of its content.
        stamp: when it was made.
        answer: what it says; None if it could not be asked.
        problem: why it could not; empty if it could.
        reference: whether it is one of the reference recordings, asked by what the others tell.
    """

    recording: str
    digest: str
    stamp: Stamp
    answer: Answer | None
    problem: str = ""
    reference: bool = False


def digest_of(path: Path) -> str:
    """SHA-256 of a recording: of a file, or of all files of a folder (a ROS 2 bag).

    Raises:
        InputError: it cannot be read.
    """
    whole = hashlib.sha256()
    try:
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        for file in files:
            if path.is_dir():
                whole.update(str(file.relative_to(path)).encode())
            with file.open("rb") as stream:
                while block := stream.read(1 << 20):
                    whole.update(block)
    except OSError as error:
        raise InputError(f"recording {path} cannot be read: {error.strerror or error}") from None
    return whole.hexdigest()


def key_of(rig: Rig, reference: Sequence[str], drift: dict[str, float], changes: Sequence[str] = ()) -> str:
    """What a watch's results belong to: rig, reference recordings, drift, what changes, and method."""
    told = [METHOD, rig.as_tree(), sorted(reference), sorted(drift.items()), *sorted(changes)]
    return hashlib.sha256(json.dumps(told, sort_keys=True, default=str).encode()).hexdigest()


class Store:
    """A folder with what was seen; without a folder nothing is kept."""

    def __init__(self, folder: Path | None, key: str) -> None:
        """Open it.

        Args:
            folder: of the results; None for none.
            key: see `key_of`.

        Raises:
            InputError: it cannot be written to, or belongs to another rig or reference.
        """
        self.folder, self.key = folder, key
        if folder is None:
            return
        with results_folder(folder):
            (folder / SEEN).mkdir(exist_ok=True)
        kept = folder / REFERENCE
        if kept.exists() and read_kept(kept, "the reference of a watch", ("key",))["key"] != key:
            raise InputError(
                f"--out {folder} holds a watch with another rig, reference, drift or changes; "
                "choose or make another folder"
            )

    def reference(self) -> tuple[Posterior, list[Seen]] | None:
        """The reference that was fitted before, and what its recordings say; None for none."""
        if self.folder is None or not (self.folder / REFERENCE).exists():
            return None
        kept = read_kept(self.folder / REFERENCE, "the reference of a watch", ("posterior", "seen"))
        arrays = {name: np.array(value) for name, value in kept["posterior"].items() if name != "over_noise"}
        posterior = Posterior(**arrays, over_noise=kept["posterior"]["over_noise"])
        return posterior, [_seen_from(each) for each in kept["seen"]]

    def keep_reference(self, posterior: Posterior, seen: Sequence[Seen]) -> None:
        """Keep a fitted reference."""
        if self.folder is None:
            return
        numbers = {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in vars(posterior).items()
        }
        content = {"key": self.key, "posterior": numbers, "seen": [_as_json(each) for each in seen]}
        with results_folder(self.folder):
            write_whole(self.folder / REFERENCE, json.dumps(content))

    def seen(self) -> dict[str, Seen]:
        """Content hash -> what was seen, of all recordings so far; one whose file is damaged is seen again."""
        found: dict[str, Seen] = {}
        if self.folder is None:
            return found
        for path in sorted((self.folder / SEEN).glob("*.json")):
            try:
                kept = read_kept(path, "a recording of a watch", ("key", "seen"))
            except InputError:
                continue
            if kept["key"] == self.key:
                each = _seen_from(kept["seen"])
                found[each.digest] = each
        return found

    def keep(self, seen: Seen) -> None:
        """Keep what a recording says."""
        if self.folder is None:
            return
        content = json.dumps({"key": self.key, "seen": _as_json(seen)})
        with results_folder(self.folder):
            write_whole(self.folder / SEEN / f"{seen.digest[:32]}.json", content)


def _as_json(seen: Seen) -> dict[str, Any]:
    return asdict(seen)


def _seen_from(kept: dict[str, Any]) -> Seen:
    answer = kept["answer"]
    if answer is not None:
        effects = tuple(_effect_from(each) for each in answer["effects"])
        answer = Answer(**{**answer, "effects": effects})
    return Seen(**{**kept, "stamp": Stamp(**kept["stamp"]), "answer": answer})


def _effect_from(kept: dict[str, Any]) -> EffectTold:
    lists = {name: tuple(kept[name]) for name in ("strengths", "rises", "shared_shares")}
    return EffectTold(**{**kept, **lists})
