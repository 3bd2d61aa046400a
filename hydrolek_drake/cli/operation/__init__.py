"""Commands that control and operate machines."""
