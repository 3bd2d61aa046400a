"""Diagnosis: locate the mismatch, name the missing physics, model it, show the fit improve."""

import logging
import os
import sys
import time

trace = logging.getLogger(__name__).debug
"""Told what a search does, for those who want to watch it: with HYDROLEK_TRACE=1 it is printed."""


class _AtProcessTime(logging.Formatter):
    """Lines that begin with the processor time used so far."""

    def format(self, record: logging.LogRecord) -> str:
        """A line of the log."""
        return f"{time.process_time():6.1f} s {record.getMessage()}"


if os.environ.get("HYDROLEK_TRACE"):
    _printed = logging.StreamHandler(sys.stdout)
    _printed.setFormatter(_AtProcessTime())
    logging.getLogger(__name__).addHandler(_printed)
    logging.getLogger(__name__).setLevel(logging.DEBUG)
