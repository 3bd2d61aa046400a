"""Commands that diagnose, and that measure how well."""
