"""Every constant of the watch, with the principle or measurement it comes from."""

METHOD = 4
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

ROUNDS = 8
"""Marquardt steps of the best effect at most, which goes on from a race, and of other fits that go on."""

LEFT_OUT = 6
"""So many reference recordings are each asked by what the others tell: enough to see how a healthy machine varies."""

OBSERVED = ((0.1, 4, 12), (0.5, 8, 6), (3.0, 12, 3))
"""Where no effect leads to the noise: time constants of observers [s], steps with each at most, and so many fits
that go on."""

CONTINUED = 32
"""Steps at the end of these at most."""

LED = 6
"""Steps of every fitted effect with slopes that are corrected by rollouts: it begins at the best of the sizes at which
it was held."""

RACED = 3
"""Steps of the `FURTHER` best of these, with slopes computed anew where those do not hold."""

BEHIND = 0.2
"""One of them ends where a step promises less than this share of how far it is behind the best: it would need five more
such steps to become the best."""

FURTHER = 2

WORTH = 0.5
"""A fit ends where a step promises less than so many squares: less than a standard deviation of any number."""

TRIED = 4.0
"""An effect whose scan promises so many squares is fitted; one that promises less is within two standard deviations of
nothing, where the scan's own likelihood tells its size."""

FITTED = 5
"""So many effects of a recording are fitted at most: the most promising ones."""

MOST_TIMES = 8
"""Places of an effect's own moment at which it is tried."""

MOST_SUDDEN = 9
"""Sizes at which an effect is tried that acts as soon as it is there: three a decade of those where searches begin."""

FAINT = 1.0
"""An effect is also tried at a size at which all that it changes is so much, in standard deviations of a number: what
own numbers bend over so little is a small part of it, and rounding (1e-12) is far below it."""

BENT = 1.5
"""An effect is told by its slope alone where, at the next size, so many times as much is left across own numbers as
in proportion to the sizes: more than half of what is left there is then not proportional to it."""

BEGUN = 3
"""So often at most effects are tried beside a nominal model: a fit with one may have led it to a lower place."""

RETRIED = 3
"""So many of the best fits lead the nominal model, ..."""

MOST_OF = 0.5
"""... which stays where it was if it takes less than this share of what the best of them gained: an effect is there."""

HELD_AT = 2.0
"""An effect is held so many standard deviations, by its slope, from where that has it: where its interval would end."""

FURTHER_OUT = 4.0
"""It is held at a size so many times as large where the squares do not rise so far, ..."""

FARTHER = 4
"""... so often at most: a bend so sharp that it hid an effect of 250 times the size that it seemed to show was seen."""

LIKELY = 2.0
"""... above those without an effect: half of what they should rise by."""

DAMPED = 1e-4
"""Damping of the steps with which own numbers follow, over that of a fit's first one: their slopes are good, and they
have begun at what those promise."""

NEGLIGIBLE = 0.1
"""They end where one promises less than this share of how far it is behind the best of all effects."""

HOPELESS = 16.0
"""An effect is not held at further sizes where another one gains more than so many squares, four standard deviations,
and more than `FURTHER_OUT` times as much as it does or promises: it imitates that one at most. Of two fits that have
ended, one that leaves so many squares more is not what is there."""

SHORTER = 1e4
"""A step that leads up is tried again with so many times the damping: with that of a fit's first one."""

AROUND = 2
"""So often a fitted effect is held on both sides of its size, farther off or nearer each time, ..."""

LEAST_RISE, MOST_RISE = 1.0, 16.0
"""... until the squares rise by an amount between these: one and four standard deviations."""

HELD = 4
"""Steps of the own numbers at each of these sizes."""

SHARED_STEP, SHARED_REACH = 0.25, 3.5
"""Errors of the reference among which evidence is weighed, in standard deviations: so near each other that fifty
recordings tell two of them apart by less than one square (a recording tells an effect no more surely than the reference
leaves it, since its prior is that of the reference), and so far that one series in two thousand lies beyond."""

UNTOLD = 0.9
"""Of a number that is known by the reference no better than to this share of its range's standard deviation it tells
nothing."""

POORER = 4.0
"""A reference whose movements tell a number so many times less a second lacks movements, not only time."""

NAMED = 5
"""So many numbers are named of those that a reference lacks."""

GRID = 4001
"""Places at which the likelihood of a size is tabulated."""

REACH = 8.0
"""The table reaches so many standard deviations beyond what is likeliest."""

POINTS = 240
"""Points of the curves that are kept of a recording."""

FEWEST = 3
"""Points from which a trend and its uncertainty can be told: two numbers, and one degree of freedom."""

NEAR = 5
"""Recordings next to each other whose median size is the usual one there: two of them may be far off."""

REWEIGHTED = 30
"""Rounds at most in which the points of a trend get their weights; a round is a fit of two numbers."""

SETTLED = 0.01
"""They are found where no weight changes by more: a hundredth of a point's weight moves no trend."""

HUBER = 1.345
"""With normal errors Huber's weights lose 5 % of the precision with this constant (Huber 1981)."""

NORMAL_MEDIAN = 0.6745
"""Median of the absolute value of a standard normal number."""

OCTAVES = 12
"""Sizes of an effect, each twice the one before, among which evidence is mixed: from half a standard deviation of one
recording, of which a hundred in a row make an alarm, to more than any wear."""

BEYOND = 10.0
"""The largest of them reaches so many octaves farther."""

STAYS, GROWS, FALLS = 0.6, 0.3, 0.1
"""Probabilities with which an effect's size is within the same factor of two in the next recording, the next larger
one, or the next smaller one: what grows by as much each time doubles in its second recording, and ever more slowly
then."""

MISHAP = 0.1
"""Probability that a recording says nothing of the machine: by it one alone cannot end an alarm's evidence."""

LAST = 2
"""Something is left beside the best effect where so many of the last recordings say so."""

TOGETHER = 12.0
"""Effects whose total gains differ by less than so many squares are not told apart, see `search.gains.GAIN_NEEDED`; and
one recording says no more, over what the scatter allows, for a name or a change point."""
