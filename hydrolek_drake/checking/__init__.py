"""What is implausible about a rig, and about a recording of it, before anything is fitted."""

from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.recording_checks import check_recording, refuse_other_clock
from hydrolek_drake.checking.rig_checks import check_rig

__all__ = ["Complaint", "check_recording", "check_rig", "refuse_other_clock"]
