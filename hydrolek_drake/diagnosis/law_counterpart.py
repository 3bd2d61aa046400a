"""The same law on the other side of the linkage: a force at the rod for a moment at the joint, or the reverse.

    M = r(q) F,   v = r(q) w,   with the lever r = d stroke / d q

Both sides are compared with the same terms: one that grew by others may miss what a fit from here finds.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law, records_of
from hydrolek_drake.diagnosis.laws import law_record
from hydrolek_drake.rollout.one_point import law_along, stroke_and_lever
from hydrolek_drake.rollout.rollout import Signals

_OTHER = {"cylinder": "load", "load": "cylinder"}


def counterpart(
    found: FoundLaw, inputs: Sequence[Input], signals: Sequence[Signals], record: np.void
) -> tuple[Law, np.ndarray] | None:
    """A law of the same terms on the other side, and the amplitudes (SI) with which it comes closest.

    Args:
        found: fitted; a periodic one, and one at another stage, has no counterpart.
        inputs: unknown inputs of the joint.
        signals: of rollouts that move as the law's machine does.
        record: the joint's parameters.
    """
    law = found.law
    other = next((i for i in inputs if i.stage == _OTHER.get(law.input.stage)), None)
    if other is None or law.periodic:
        return None
    seen, lever = (
        np.concatenate(parts) for parts in zip(*(seen_by_laws(s, record) for s in signals), strict=True)
    )
    over = lever if law.input.stage == "cylinder" else 1.0 / lever
    wanted = over * sum(law_along(row, seen) for row in records_of(law, found.span, found.values))
    terms = law.at(found.values).terms
    columns = [law_along(law_record(other.probe, found.span, term, 1.0)[0], seen) for term in terms]
    amplitudes, *_ = np.linalg.lstsq(np.stack(columns, axis=1), wanted, rcond=None)
    there = replace(law, input=other)
    return there, np.concatenate([amplitudes, found.values[law.sizes :]])


def seen_by_laws(run: Signals, record: np.void) -> tuple[np.ndarray, np.ndarray]:
    """What a law may depend on (`physics.law.Seen` as rows) and the lever, where the rollout is finite."""
    there = np.isfinite(run.position)
    t, q, w, p_a, p_b, x = (
        each[there]
        for each in (run.time, run.position, run.velocity, run.pressure_a, run.pressure_b, run.spool)
    )
    stroke, lever = np.array([stroke_and_lever(angle, record) for angle in q.tolist()]).T
    return np.stack([t, q, w, stroke, lever * w, p_a, p_b, x], axis=1), lever
