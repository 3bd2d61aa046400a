"""Joints of a machine that move together, driven through commands: what the Diagram does, compiled."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.kinematics.rigid_links import rigid_links
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.law import LAW, law_of
from hydrolek_drake.physics.serial_arm import Links, motion_equation, scratch
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import Drive, State
from hydrolek_drake.rollout.rollout import rest_state
from hydrolek_drake.rollout.together_kernel import TOLD, integrate_together, room

_NO_LINKS = Links(
    np.zeros(0, dtype=np.int64),
    np.zeros((0, 3, 3)),
    np.zeros((0, 3)),
    np.zeros((0, 3)),
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros((0, 3, 3)),
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros(3),
)


@dataclass(frozen=True)
class Together:
    """What joints did; SI units.

    Attributes:
        time: [s]. # (k,)
        joints: their names, in the order of the columns.
        signals: those of a rollout, and `drawn`, the flow from the supply [m^3/s]. # each (k, joints)
        diverged: None, or when it diverged; rows from then on are NaN.
    """

    time: np.ndarray
    joints: tuple[str, ...]
    signals: dict[str, np.ndarray]
    diverged: str | None


def moving_with(rig: Rig, joints: Sequence[str]) -> tuple[str, ...]:
    """Joints that move when some are driven: all of their arms, which give way on their oil; else these alone."""
    sides = {joint.split("_")[0] for joint in joints if rig.variant(joint, "load") == "arm"}
    return tuple(j for j in rig.joints if j in joints or (_of_arm(rig, j) and j.split("_")[0] in sides))


def roll_out_together(
    rig: Rig,
    joints: Sequence[str],
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    positions: np.ndarray,
    longest_step: float | None = None,
) -> Together:
    """Drive joints that move together, from rest.

    Args:
        rig: the machine.
        joints: that move, in the rig's order; the rest is held. All are hydraulic.
        command_times: [s], increasing. # (m,)
        command_values: [V], each held until the next, neutral before the first has arrived. # (m, joints)
        times: when signals are wanted [s], increasing. # (k,)
        positions: where they rest at the first of these [rad or m]. # (joints,)
        longest_step: of the integration [s]; None for the rig's own.
    """
    places = [rig.joints.index(joint) for joint in joints]
    records = rig.records()
    own = np.ascontiguousarray(records[places])
    links = _links(rig, joints, records)
    begun = [rest_state(own[i : i + 1], float(q), carried=c) for i, (q, c) in _at_rest(own, links, positions)]
    states = np.array([state[2:11] for state in begun])
    drives = np.array([[state[13], state[14], state[15], state[0], state[1]] for state in begun])
    assert states.shape[1] == len(State._fields) and drives.shape[1] == len(Drive._fields) + 1
    laws = [law_of(own[i : i + 1]) for i in range(len(own))]
    rows = [np.zeros(0, LAW) if law is None else law for law in laws]
    first = np.concatenate([[0], np.cumsum([len(law) for law in rows])])
    told = np.full((times.size, len(own), len(TOLD)), np.nan)
    changes = np.concatenate([[True], np.any(np.diff(command_values, axis=0) != 0.0, axis=1)])
    done = integrate_together(
        own,
        states,
        drives,
        np.array([state[11] for state in begun]),
        read_only(command_times[changes]),
        read_only(command_values[changes]),
        read_only(times),
        longest_step or rig.value("integration.longest_step"),
        round(rig.value("integration.spool_steps")),
        np.concatenate(rows),
        first,
        links,
        scratch(len(links.mass)),
        room(len(own)),
        told,
    )
    diverged = None if done == times.size else f"left all bounds at {times[done]:.3f} s"
    signals = {name: told[:, :, place] for place, name in enumerate(TOLD)}
    return Together(times, tuple(joints), signals, diverged)


def _at_rest(own: np.ndarray, links: Links, positions: np.ndarray) -> list[tuple[int, tuple[float, float | None]]]:
    """Joint -> where it rests, and gravity's moment on it there; None where it carries no other joint."""
    n = len(links.mass)
    carried: list[float | None] = [None] * len(own)
    if n:
        bias = np.zeros(n)
        hanging = np.array([hooks.payload(0.0, record) for record in own])
        still, q = np.zeros(n), np.array(positions, dtype=float)
        motion_equation(links, q, still, hanging, scratch(n), np.zeros((n, n)), bias)
        carried = bias.tolist()
    return list(enumerate(zip(np.array(positions).tolist(), carried, strict=True)))


def _of_arm(rig: Rig, joint: str) -> bool:
    return rig.variant(joint, "load") == "arm"


def _links(rig: Rig, joints: Sequence[str], records: np.ndarray) -> Links:
    """Links of the arms, with what does not move where the rig holds it."""
    if not _of_arm(rig, joints[0]):
        return _NO_LINKS
    resting = dict(zip(rig.joints, records["load"]["initial_position"].tolist(), strict=True))
    held = {j: q for j, q in {**resting, **rig.held}.items() if j not in joints}
    return _links_of(tuple(joints), tuple(sorted(held.items())))


@cache
def _links_of(joints: tuple[str, ...], held: tuple[tuple[str, float], ...]) -> Links:
    return rigid_links(joints, dict(held))
