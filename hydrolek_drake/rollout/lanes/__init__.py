"""Many machines stepped in lockstep, one in each lane of vector instructions."""
