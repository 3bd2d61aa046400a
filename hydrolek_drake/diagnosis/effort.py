"""How much work the search for effects spends, and how near the noise is near."""

COARSE = 4.0
"""Integration step of the first fits over the rig's own: 16 times its error, a quarter of its time."""

FAR, NEAR = 3.0, 1.3
"""A model this many times above the noise is searched with the coarse step, or with twice the rig's own: the
error of the step must stay far below what is to be explained."""

NEARLY = 1.5
"""A third effect is looked for only if two leave at most this many times the noise: it would be a small one."""

NOISE_KNOWN = 0.015
"""Relative uncertainty of the noise level, which is estimated from the recording."""

AT_NOISE = 1.0 + NOISE_KNOWN
"""A model that leaves so many times the noise or less leaves nothing that could be told from noise."""

ABOVE_NOISE = 1.0 + 2.0 * NOISE_KNOWN
"""Where no effect promises anything, a model is taken to lack one only if it leaves more than this."""

MORE_AHEAD = 1.0 + 4.0 * NOISE_KNOWN
"""A model lacks something ahead if it leaves so many times the noise there, whatever its uncertainty accounts for: four
times what the noise is known to. Numbers that are bent are uncertain too."""

GLANCE_S = 20.0
"""First fits see so many seconds at least: errors that grow with time are smaller, and so is the work."""

GLANCE, LOOK, POLISH = 4, 15, 8
"""Trust-region steps of a first fit, of one that is followed up, and of one with the rig's own step."""

FALLING = 0.1
"""A round of a fit that is worth another one takes this share of what is left."""

BEAM = 3
"""So many hypotheses are extended by a further effect, and only the best once it is near the noise."""

MOST_EFFECTS = 3
"""At most so many effects are searched together."""

HOPELESS = 4.0
"""First fits whose squared residuals are so many times the best one's are not followed up."""
