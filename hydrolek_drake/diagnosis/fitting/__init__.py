"""Many fits side by side: rollouts in lanes, descents in lockstep, line searches, races."""
