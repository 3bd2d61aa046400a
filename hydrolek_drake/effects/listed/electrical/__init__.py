"""Command, amplifier and sensor."""
