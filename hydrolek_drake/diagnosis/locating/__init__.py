"""Where a mismatch enters, when, and against which variable: unknown inputs, estimated."""
