"""Concealed cases diagnosed and scored, here or on the workers of a cluster."""

import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hydrolek_drake.challenge.cases import read_case, record
from hydrolek_drake.challenge.plants import Plant, record_plant
from hydrolek_drake.challenge.scoring import score
from hydrolek_drake.diagnosis.diagnosis import diagnose
from hydrolek_drake.diagnosis.remarks import INTERRUPTED
from hydrolek_drake.diagnosis.report.as_json import as_json
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.runs.remaining import Remaining
from hydrolek_drake.runs.report import prepare_folder

REPORT = "report.json"
SIDES = ("train", "holdout")


def diagnosed(
    rig: Rig,
    folder: Path,
    pool: Executor,
    cores: int,
    say: Callable[[str], None] = lambda text: None,
    more: Callable[[str], None] = lambda text: None,
) -> None:
    """Diagnose what was recorded in a folder, and write the report there.

    Args:
        rig: the nominal model.
        folder: of the case.
        pool: threads.
        cores: that roll out at the same time.
        say: told what is being done.
        more: told how it stands.

    Raises:
        KeyboardInterrupt: the diagnosis was interrupted.
    """
    train, held_out = (read_recording(folder / f"{side}.csv", rig.columns) for side in SIDES)
    done = diagnose(rig, [train], [held_out], pool, say, cores=cores, more=more)
    if INTERRUPTED in done.reasons:
        raise KeyboardInterrupt
    write_whole(folder / REPORT, json.dumps(as_json(done), indent=1))


def elsewhere(rig: Rig, label: Mapping[str, Any]) -> dict[str, str]:
    """Record and diagnose a case on a worker of a cluster, which has one thread for it.

    Args:
        rig: the nominal model of its machine.
        label: of the case.

    Returns:
        Name -> content of the files that the case's folder holds.
    """
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(1) as pool:
        folder = Path(name)
        record(rig, read_case(label), folder)
        diagnosed(rig, folder, pool, 1)
        return {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.iterdir())}


@dataclass(frozen=True)
class Series:
    """Cases on their way to their scores.

    Attributes:
        told: labels, in order.
        scored: name -> score, filled as cases end.
        out: folder of the challenge.
        sample: what tells these cases' folders from others.
        rigs: name -> machine's nominal model.
        foreign: name -> FMU in a machine's place.
        say: told what is being done, and how far it is.
        more: told how the case at hand stands.
    """

    told: Sequence[dict[str, Any]]
    scored: dict[str, Any]
    out: Path
    sample: str
    rigs: Mapping[str, Rig]
    foreign: Mapping[str, Plant]
    say: Callable[[str], None]
    more: Callable[[str], None]

    def here(self, cores: int) -> None:
        """One case after the other on this computer."""
        remaining = Remaining(len(self.told))
        with ThreadPoolExecutor(cores) as pool:
            for number, label, folder in self._left(remaining):
                title = f"case {number} of {len(self.told)}{remaining.words()}"

                def say(text: str, title: str = title) -> None:
                    self.say(f"{title}: {text} ...")

                say("recording")
                if label["name"] in self.foreign:
                    plant = self.foreign[label["name"]]
                    record_plant(plant, folder)
                    diagnosed(plant.rig, folder, pool, cores, say, self.more)
                else:
                    case = read_case(label)
                    record(self.rigs[case.rig], case, folder)
                    diagnosed(self.rigs[case.rig], folder, pool, cores, say, self.more)
                self._score(number, label, folder)
                remaining.one_ended()

    def over(self, address: str) -> None:
        """Cases side by side on the workers of a cluster; one whose workers died is left for the next time."""
        lost: dict[str, Exception] = {}
        remaining = Remaining(len(self.told))
        with ClusterJobs(address) as cluster:
            self.say(f"{len(self.told)} cases over {address} ...")
            jobs = (
                ((number, label, folder), (self.rigs[read_case(label).rig], label))
                for number, label, folder in self._left(remaining)
            )
            for (number, label, folder), found in cluster.done(elsewhere, jobs):
                remaining.one_ended()
                if isinstance(found, Exception):
                    lost[label["name"]] = found
                    continue
                prepare_folder(folder)
                for name in sorted(found, key=lambda name: name == REPORT):  # last: with it the case is done
                    write_whole(folder / name, found[name])
                self._score(number, label, folder, remaining.words())
        for name, error in lost.items():
            raise InputError(
                f"--cluster {address}: {len(lost)} cases were lost, the first {name} "
                f"({type(error).__name__}: {error}); the same command goes on with these"
            )

    def _left(self, remaining: Remaining) -> Iterator[tuple[int, dict[str, Any], Path]]:
        """Cases that are neither scored nor diagnosed; those that are diagnosed are scored on the way."""
        for number, label in enumerate(self.told, start=1):
            folder = self.out / f"{label['name']}_{self.sample}"
            if label["name"] in self.scored:
                remaining.one_ended(at_once=True)
                continue
            if (folder / REPORT).exists():
                self._score(number, label, folder)
                remaining.one_ended(at_once=True)
            else:
                yield number, label, folder

    def _score(self, number: int, label: dict[str, Any], folder: Path, left: str = "") -> None:
        answered = read_kept(folder / REPORT, "the report of a case diagnosed before", ("verdict",))
        self.say(f"case {number} of {len(self.told)}: {answered['verdict']}{left}")
        self.scored[label["name"]] = score(label, answered)
