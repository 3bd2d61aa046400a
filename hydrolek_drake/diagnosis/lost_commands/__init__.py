"""Commands that got lost on their way."""
