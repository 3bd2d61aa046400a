"""A rig's parameters: what is declared about each, how a file states it, and those that follow from the arms."""
