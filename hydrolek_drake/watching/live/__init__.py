"""A machine watched while it runs: samples as they come, an observer of the fitted model, alarms and a page."""
