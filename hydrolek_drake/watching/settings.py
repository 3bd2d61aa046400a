"""Every constant of the watch, with the principle or measurement it comes from."""

METHOD = 2
"""Number of the method: recordings that another one was asked of are asked again."""

DRIFT = 0.02
"""By how much (one standard deviation) each of the machine's own numbers may differ from one recording to another, as a
share of its range in the rig: a range says how far machines of the build differ, one machine varies far less."""

FALSE_ALARMS = 0.01
"""Probability of any alarm in a whole series of a healthy machine, however long it is."""

NOMINAL = 12
"""Marquardt steps of the nominal model's fit at most: it begins where the reference ended, and mostly ends sooner."""

CHANGED_LOG2 = 6
"""The ranges of what changes between recordings are filled with two to this power places: with two numbers an eighth of
a range apart."""

CHANGED_KEPT = 4
"""So many of them are fitted."""

CHANGED = 40
"""Marquardt steps of these at most: from elsewhere in the range of a load, twelve were not enough (bench, three of four
recordings)."""

ROUNDS = 5
"""Marquardt steps of the best effects at most, which go on from other fits."""

LEFT_OUT = 6
"""So many reference recordings are each asked by what the others tell: enough to see how a healthy machine varies."""

OBSERVED = ((4, 12), (8, 6), (12, 3))
"""Steps with each observer at most where no effect leads to the noise, and so many fits that go on: as many as in a
race of the diagnosis."""

CONTINUED = 32
"""Steps at the end of these at most."""

RACED = 3
"""Steps of every fitted effect, and once more of the `FURTHER` best ones, which then tell the best of all: after three
steps alone a fade of the amplifier's gain by 8 % was still behind another effect, with eight it left less."""

FURTHER = 3

WORTH = 0.5
"""A fit ends where a step promises less than so many squares: less than a standard deviation of any number."""

TRIED = 4.0
"""An effect whose scan promises so many squares is fitted; one that promises less is within two standard deviations of
nothing, where the scan's own likelihood tells its size."""

FITTED = 5
"""So many effects of a recording are fitted at most: the most promising ones."""

EXACT = 2
"""Of so many, the best ones, every slope is computed anew where the fit ended."""

MOST_TIMES = 8
"""Places of an effect's own moment at which it is tried."""

GRID = 4001
"""Places at which the likelihood of a size is tabulated."""

REACH = 8.0
"""The table reaches so many standard deviations beyond what is likeliest."""

POINTS = 240
"""Points of the curves that are kept of a recording."""

FEWEST = 3
"""Points from which a trend and its uncertainty can be told: two numbers, and one degree of freedom."""

REWEIGHTED = 30
"""Rounds at most in which the points of a trend get their weights; a round is a fit of two numbers."""

SETTLED = 0.01
"""They are found where no weight changes by more: a hundredth of a point's weight moves no trend."""

HUBER = 1.345
"""With normal errors Huber's weights lose 5 % of the precision with this constant (Huber 1981)."""

NORMAL_MEDIAN = 0.6745
"""Median of the absolute value of a standard normal number."""

PERSISTENCE = 2
"""Recordings in a row that must be beyond the threshold before it is an alarm: one alone may be a mishap."""

TOGETHER = 12.0
"""Effects whose total gains differ by less than so many squares are not told apart, see `search.gains.GAIN_NEEDED`; and
one recording says no more, over what the scatter allows, for a name or a change point."""
