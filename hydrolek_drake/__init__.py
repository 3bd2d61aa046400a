"""Digital twin of hydraulic manipulators on Drake."""

from hydrolek_drake.compiled import use_cache_for_this_source

__version__ = "0.1.0"

use_cache_for_this_source()
