"""How near the noise is near."""

FAR = 3.0
"""Structures this many times above the noise are told apart by rollouts with twice the rig's own step: its error stays
far below what is to be explained."""

NOISE_KNOWN = 0.015
"""Relative uncertainty of the noise level, which is estimated from the recording."""

AT_NOISE = 1.0 + NOISE_KNOWN
"""A model that leaves so many times the noise or less leaves nothing that could be told from noise."""

ABOVE_NOISE = 1.0 + 2.0 * NOISE_KNOWN
"""A model that leaves more than this is surely above the noise."""

MORE_AHEAD = 1.0 + 4.0 * NOISE_KNOWN
"""A model lacks something ahead if it leaves so many times the noise there, whatever its uncertainty accounts for: four
times what the noise is known to. Numbers that are bent are uncertain too."""
