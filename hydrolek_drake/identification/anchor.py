"""Residuals that are known at a place, for rollouts elsewhere that are the same as there."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.rollout.run import Run


class Anchor:
    """Residuals of each experiment at a place: a column of the Jacobian changes few joints of a machine."""

    def __init__(self, runs: Sequence[Run] = (), residuals: Sequence[np.ndarray] = ()) -> None:
        """Keep.

        Args:
            runs: the rollouts at the place, one for each experiment; none where no place is known yet.
            residuals: of each. # (values,) each
        """
        self._at = [(_all_of(run), part) for run, part in zip(runs, residuals, strict=True)]

    def known(self, experiment: int, run: Run) -> np.ndarray | None:
        """Residuals of an experiment; None where its rollout is not that of the place. # (values,).

        Args:
            experiment: its number.
            run: its rollout.
        """
        if not self._at:
            return None
        known, residuals = self._at[experiment]
        return residuals if known == _all_of(run) else None


def _all_of(run: Run) -> tuple[bytes, ...]:
    """What tells one of an experiment's rollouts from another."""
    law = b"" if run.law is None else run.law.tobytes()
    return run.joint.tobytes(), law, run.command_times.tobytes(), run.command_values.tobytes()
