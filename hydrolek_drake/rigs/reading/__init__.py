"""From a rig file to the machine: which file it is, what it is made of, its keys, and the schema that editors use."""
