"""How near the noise is near, what must be gained, how structures are judged, and what data must have."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Noise:
    """How near the noise is near; root mean squares over the noise."""

    known: float = 0.015
    """Relative uncertainty of the noise level, which is estimated from the recording."""

    far: float = 3.0
    """Structures this many times above the noise are told apart by rollouts with twice the rig's own step: its error
    stays far below what is to be explained.

    Held-out residuals so large are no small deviation from a model that is right: they speak against it as they are,
    unless it explains the training data. Then a joint may have stuck or slipped where a hair's breadth decides, and is
    off from there on; whether other values of its parameters follow both is tried.
    """

    explained_held_out: float = 1.5
    """A structure with additions explains held-out data if it leaves at most so much, since these numbers' own
    uncertainty adds to the noise.

    That nothing is missing is said of a nominal model only if it predicts held-out data as well as it must explain the
    others.
    """

    @property
    def at(self) -> float:
        """A model that leaves so much or less leaves nothing that could be told from noise."""
        return 1.0 + self.known

    @property
    def above(self) -> float:
        """A model that leaves more than this is surely above the noise."""
        return 1.0 + 2.0 * self.known

    @property
    def held_out(self) -> float:
        """A model lacks something if it leaves so much of held-out data, whatever its uncertainty accounts for.

        It is four times what the noise is known to: numbers that are bent are uncertain too.
        """
        return 1.0 + 4.0 * self.known

    @property
    def explained(self) -> float:
        """A model explains the training data if it leaves at most so much: eight times what the noise is known to.

        A listed effect that is named wrongly leaves 3 times the noise or more.
        """
        return 1.0 + 8.0 * self.known


NOISE = Noise()


@dataclass(frozen=True)
class Gains:
    """What an addition must bring before it is believed, as falls of the squared residuals."""

    needed: float = 12.0
    """Smallest gain that is followed up: 3.5 standard deviations of one size."""

    promising: float = 0.75
    """An effect is tried if it promises this share of what it must bring: the sizes at which it was tried may be
    wrong, which near the noise, where promises count, makes few of them too small by a quarter."""

    visible: float = 16.0
    """Gain at which an effect would have been seen: four standard deviations of its size."""

    certain: float = 5.0
    """Standard deviations beyond doubt: what a proposed experiment has to show, and the root of what a window of lost
    commands must promise, since hundreds are tried."""

    told_apart: float = 2.0
    """Fall of the cost that is one: half of it is a log-odds of one, what a further parameter must bring."""

    fidelity: float = 0.004
    """Gain, as a share of the values, below which an effect is not told from what every model leaves out: 0.2 % of
    the noise's rms."""

    law: float = 2.0
    """A law costs as many effects: where it enters and what it depends on are both chosen among many. So do lost
    commands, of which each window must pay for itself besides."""

    def of_one_more(self, counted: int, unsure: float = 0.0) -> float:
        """What one more addition must bring: more than chance would, and than what is known but roughly may leave.

        Args:
            counted: values of the data.
            unsure: squared residuals that what is known but roughly may leave.
        """
        return max(self.needed, self.fidelity * counted, unsure)


GAINS = Gains()


@dataclass(frozen=True)
class Evidence:
    """How structures are compared on data that none was fitted to, and how far numbers are known."""

    significance: float = 0.05
    """Share of repetitions in which an interval may miss the true value. A structure at least this probable belongs
    to the group that the data cannot tell apart."""

    deviations: float = 2.0
    """Standard deviations that hold a little more than the rest of them: two structures that differ by less are not
    told apart, and the search for the end of an interval begins there."""

    sure: float = 0.7
    """Below this probability of the best structure the answer is a group, not a name."""

    effect_cost: float = 4.5
    """Log-odds against each further effect at least: with some twenty to choose from, chance has to be paid for."""

    parameter_cost: float = 2.0
    """Log-odds against each further parameter, so that a special case is preferred to what contains it."""

    nearby: float = 100.0
    """If uncertain parameters account for more than this of the held-out squared residuals, they have to move so far
    that the first order may not hold: r' (I + J S J')^-1 r is then what both data leave, fitted together, beyond what
    the training data leave alone."""

    out_of_reach: float = 150.0
    """Half the squared residuals by which a structure is beyond all doubt behind the best."""

    doubt: float = 0.05
    """The same as a share of the squares that the best one leaves, where these are far from the noise: what no
    structure explains differs by more from one local minimum to the next."""

    most_judged: int = 8
    """At most so many structures are judged."""

    phases: int = 12
    """Where a periodic law may stand when a recording begins is first tried at so many places."""

    worth: float = 0.1
    """Squares that a step of the last fit must promise: it moves a number by a third of its standard deviation at
    most otherwise."""

    renewed: float = 0.3
    """Squares that new slopes must bring, or the last fit ends: half a standard deviation along a valley.
    Where jumps make slopes rough, eight Jacobians in a row brought 0.3 each."""

    lower: float = 1.0
    """Another place is lower if it leaves so many squares less: it is a standard deviation away, or another local
    minimum."""

    moments: int = 120
    """So many moments are tried over a range: four a second of a recording of half a minute, less than a move takes."""

    closer: int = 12
    """So many times closer together about the fitted one."""

    @property
    def confidence(self) -> float:
        """Share of repetitions in which an interval holds the true value."""
        return 1.0 - self.significance


EVIDENCE = Evidence()


@dataclass(frozen=True)
class Data:
    """Whether recordings can be diagnosed, which parts are held out, and how much a value counts."""

    least_samples: int = 200
    """Fewer samples than this cannot decide between some twenty effects and ten nominal parameters."""

    least_travel: float = 20.0
    """The joint must move by this many times the noise, or there is no movement to explain."""

    most_missing: float = 0.3
    """Share of missing values above which a signal is no measurement of the whole recording."""

    most_saturated: float = 0.2
    """Share of the time at a sensor's limit above which the signal does not show the movement."""

    frozen_span_s: float = 1.0
    """A sensor that repeats one value for so long while the command drives the joint may have frozen."""

    most_frozen: float = 0.25
    """Share of the time with a frozen sensor above which the recording is unusable."""

    blocks: int = 6
    """Without a held-out recording, each recording is cut into so many blocks ..."""

    held_every: int = 3
    """... of which one of so many is held out: one in the middle and the last."""

    others_unknown: float = 0.1
    """What other joints do to one is known to this share: their areas and masses are the rig's own, unfitted, and
    their speeds come from smoothed angles."""

    motion_step_s: float = 1e-3
    """Of the samples of what the joints do to each other [s]: a tenth of the period of the fastest shaking of an
    arm."""

    @property
    def short_blocks(self) -> int:
        """Held-out data are cut into so many blocks, of which every other one chooses and those between report.

        Where they show what the training data do not, two of three are fitted too: short ones, so that what they show
        is in every part.
        """
        return self.held_every * self.blocks


DATA = Data()


@dataclass(frozen=True)
class Experiments:
    """The next experiment, and the smallest sizes that would have been seen."""

    duration_s: float = 40.0
    """Of a proposed recording [s]: twenty of the moves of 2 s that most of them are made of."""

    sample_s: float = 0.01
    """Between its samples [s]: half a sample of a controller, so that every change of the command is seen."""

    rounds: int = 6
    """Sizes that are tried for an effect."""

    stride: float = 5.0
    """From one to the next, at most."""

    near_enough: float = 3.0
    """A size is taken that shows at most so many times what is needed."""

    @property
    def aim(self) -> float:
        """The next size is to show so many times what is needed, so that it is not missed by a hair."""
        return 0.5 * self.near_enough


EXPERIMENTS = Experiments()
