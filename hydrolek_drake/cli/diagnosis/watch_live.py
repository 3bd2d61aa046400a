"""`hydrolek watch --live`: a machine watched while it runs."""

import signal
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.rigs import Rig
    from hydrolek_drake.watching.limits import Limit
    from hydrolek_drake.watching.live.running import Options


def watch_live(rig: "Rig", reference: Sequence[Path], options: "Options", limits: "Sequence[Limit]") -> bool:
    """Follow a stream until Ctrl-C, then leave table and page as `hydrolek watch` does; whether there is an alarm.

    Args:
        rig: the machine.
        reference: recordings of the healthy machine.
        options: as given.
        limits: that the user set.
    """
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.teleop.access import SHORTEST_TOKEN, is_loopback, new_token
    from hydrolek_drake.watching.live.choosing import TCP
    from hydrolek_drake.watching.live.running import run_live
    from hydrolek_drake.watching.results import write_watch
    from hydrolek_drake.watching.words import sentences

    output = console()

    def told(text: str) -> None:
        output.print(text, markup=False, soft_wrap=True)

    token = options.token
    if token is not None and (len(token) < SHORTEST_TOKEN or not token.isascii() or len(token.split()) != 1):
        raise InputError(f"watch: --token must be one word of at least {SHORTEST_TOKEN} plain characters")
    host = options.source.removeprefix(TCP).rpartition(":")[0].strip("[]")
    if options.source.startswith(TCP) and host and not is_loopback(host):
        options = replace(options, token=token or new_token())
        told(f"a sender begins with TOKEN {options.token}")
    else:
        options = replace(options, token=None)
    signal.signal(signal.SIGTERM, _interrupt)  # a service manager's stop leaves table and page, too
    with progress("starting") as tell:
        outcome = run_live(rig, reference, options, lambda text: tell(f"{text} ..."), told)
        written = []
        if options.folder is not None:
            tell("writing table and page ...")
            written = write_watch(outcome.watched, options.folder, limits)
    counts = outcome.follower.merger.counts
    told("")
    if outcome.innovations:
        told(f"Alarm: {outcome.innovations}")
    for line in sentences(outcome.watched, limits):
        told(line)
    told(
        f"{counts.taken} samples, {counts.lost} lost, {counts.late} late, {counts.doubled} doubled, "
        f"{counts.too_late + counts.astray} dropped; {outcome.follower.happened} gaps, jumps and alarms."
    )
    if written:
        told(f"\npage: {written[-1]}")
    return outcome.alarmed


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt
