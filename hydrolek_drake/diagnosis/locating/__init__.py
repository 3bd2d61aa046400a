"""Where a mismatch enters, when, and what it depends on."""
