"""One thing that looks wrong, and how it is mended."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Complaint:
    """What looks wrong.

    Attributes:
        about: path in the rig, signal of the recording, or "time".
        says: what is implausible, and against what.
        line: YAML for the rig that mends it, or empty.
        wrong: whether it must be wrong; else it is only told.
    """

    about: str
    says: str
    line: str = ""
    wrong: bool = True

    def sentence(self) -> str:
        """In one line."""
        return f"{self.about}: {self.says}" + (f"; in the rig: {self.line}" if self.line else "")
