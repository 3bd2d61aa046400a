"""Forms of the thesis's controllers, simulated many at a time (`controller_forms.py`)."""
