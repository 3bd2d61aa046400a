"""How a diagnosis stands while it goes on: what is tried, what is best so far, how long the race of fits may take."""

import math
import time
from collections.abc import Callable, Sequence

from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.replay.display import ratio


class Progress:
    """Tells how the fits of a diagnosis stand."""

    def __init__(
        self, more: Callable[[str], None] = lambda text: None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Nothing is fitted yet.

        Args:
            more: told how it stands, once a round of the fits.
            clock: [s].
        """
        self._more, self._clock = more, clock
        self._best: tuple[float, str] | None = None

    def reached(self, label: str, over_noise: float) -> None:
        """A structure was fitted to all of the data.

        Args:
            label: of the structure.
            over_noise: root mean square of what it leaves over the noise.
        """
        if self._best is None or over_noise < self._best[0]:
            self._best = (over_noise, label)

    def anew(self) -> None:
        """What was best so far was fitted to other data."""
        self._best = None

    def rounds(
        self, labels: Sequence[str], rungs: Sequence[Rung], number: int, alive: Callable[[], None]
    ) -> Callable[[], None]:
        """What is to be called before each round of the fits of one rung of a race.

        How long the rung may take is what its rounds took so far, times those that are left; its fits may end sooner.

        Args:
            labels: of the structures that are fitted.
            rungs: of the race.
            number: of the rung.
            alive: raises what ends the fits.
        """
        begun, done = self._clock(), 0
        most = rungs[number].rounds
        models = len(set(labels))
        what = f"{models} models ({labels[0]} first)" if models > 1 else labels[0] if labels else "no model"

        def before_round() -> None:
            nonlocal done
            alive()
            left = ""
            if done:
                most_s = (self._clock() - begun) / done * (most - done)
                left = f", at most about {math.ceil(most_s)} s more"
            done += 1
            turn = f"pass {number + 1} of {len(rungs)}, " if len(rungs) > 1 else ""
            self._more(f"{what}, {turn}iteration {min(done, most)} of at most {most}{left}{self._so_far()}")

        return before_round

    def _so_far(self) -> str:
        if self._best is None:
            return ""
        over_noise, label = self._best
        return f"; best so far: {label}, {ratio(over_noise)} times the noise"
