"""The project's jobs as plain functions, for notebooks and scripts: no pools or callbacks to prepare."""

from hydrolek_drake.api.functions import diagnose, fit, load_rig, read, replay, watch
from hydrolek_drake.api.recordings import to_pandas
from hydrolek_drake.api.results import Result
from hydrolek_drake.api.results_of_models import DiagnosisResult, FitResult, ReplayResult
from hydrolek_drake.api.watch_result import WatchResult

__all__ = [
    "DiagnosisResult",
    "FitResult",
    "ReplayResult",
    "Result",
    "WatchResult",
    "diagnose",
    "fit",
    "load_rig",
    "read",
    "replay",
    "to_pandas",
    "watch",
]
