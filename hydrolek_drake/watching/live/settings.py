"""Every constant of the live watch, with the principle or measurement it comes from."""

PULL_S = 0.5
"""Time constant with which the observer is pulled to what was measured: a rate that is wrong by r shows as an
innovation of r times this, against noise that a block averages; errors of what nobody knew (a lost command) are
forgotten in it."""

UNSURE = 0.3
"""A command that changed while samples were lost is a matter where the joint may have moved by more than so many
standard deviations of its reading meanwhile."""

LAG_S = 0.5
"""Spool and oil have followed a command after so long: where the model was told 20 ms late of a step by 8 V, the
bench's innovations were up to 30 times the noise and rang for 0.35 s."""

SETTLED = 4.0
"""After so many pull times less than 2 % of a wrong beginning is left; until then innovations are not judged."""

BLOCK_S = 1.0
"""Innovations are judged in blocks of twice the pull time: neighbouring blocks then hardly depend on each other."""

WHOLE = 0.5
"""A block with less than this share of its samples is not judged."""

LEAST_BLOCKS = 12
"""Blocks that the reference must give: with fewer, the chi squared bound of their variance would be three times it."""

SURE = 0.95
"""One-sided confidence with which the reference's blocks bound the healthy variance."""

LOST = 0.05
"""Share of the reference's samples that are left out where its innovations are told, so that a link which loses as many
is no fault of the machine."""

SHIFTS = (0.5, 1.0, 2.0, 4.0)
"""Alternatives for the mean of a block, both signs, in standard deviations of the healthy one: a factor of two apart,
which costs little where the truth lies between (Lorden, Annals of Mathematical Statistics 42, 1971)."""

SPREADS = (1.5, 2.0, 4.0, 8.0)
"""Alternatives for the mean square of a block, as multiples of the healthy one."""

MOST_NATS = 5.0
"""A block counts for so much evidence at most, which only lowers what a healthy machine gives: one mishap, however
large, is then no alarm."""

REORDERED = 25
"""A message may be late by so many sample intervals and is put in its place (0.25 s at 100 Hz); the observer is behind
by as much."""

GAP = 25
"""An interval longer than so many usual ones is a gap: what was commanded meanwhile is not known, and the observer
begins anew. Shorter ones are bridged with the command held, and forgotten within the pull time."""

AGREED = 10
"""So many messages in a row must agree on a new time before it is taken for a gap or a jump: with 5 % of all messages
astray, chance does that once in 10^13 messages."""

SILENT_S = 1.0
"""A link that brings nothing for so long is shown as silent; four times what a message may be late at 100 Hz."""

WINDOW_S = 40.0
"""Length of what is asked which effect changed: as the recordings on which the watch was measured."""

UNSETTLED_S = 1.0
"""At the beginning of a window nothing counts for so long: the observer's pressures are those of the healthy model."""

BEFORE_S = 1.0
"""Commands before a window that may still have to arrive in it are kept for so long; no transport delay is longer."""

KEPT = 500
"""Windows whose answers are kept for table and page, so that memory and disk stay the same: older ones are dropped, and
counted on."""

HISTORY_S = 60.0
SHOWN_HZ = 20.0
"""The page shows the last minute, so many samples a second."""

EVENTS = 50
"""Gaps, jumps and restarts that the page lists."""

STATE_S = 0.2
"""The page is told what is new so often."""

POLL_S = 0.05
"""Sources are asked for what is new so often."""

BAG_POLL_S = 5.0
"""Bags that are being written are read so often: each time a process is started for half a second, and recorders write
chunks of seconds anyway."""

AT_A_TIME = 500
"""Samples that are observed before the page is served again: a twentieth of a second of work for one joint."""

WAITING = 100_000
"""Samples that wait for the observer at most; beyond, the oldest are dropped, counted and shown."""

PIECE = 1 << 20
"""Bytes that are read of a growing file at a time."""

LONGEST_LINE = 1 << 16
"""Bytes of a line; a sample of a thousand signals takes a quarter of it."""

QUIET_S = 2.0
"""A file in a format that can only be read when it is complete counts as complete when it has not grown for so long."""

BAD_IN_A_ROW = 100
"""A sender whose lines are no samples so often in a row is no sender of samples, and is cut off."""
