"""State-dependent-parameter models from open-loop step tests (thesis sections 6.1 to 6.3)."""

from hydrolek_drake.identification.sdp.identify import SdpIdentification, identify_sdp

__all__ = ["SdpIdentification", "identify_sdp"]
