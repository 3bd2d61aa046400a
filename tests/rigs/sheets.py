"""Data sheets that the wizard is asked with."""

LINK = {
    "moves": "link", "bore": "40 mm", "rod": "22 mm", "stroke": "0.2 m", "base_mount": "0.10, -0.30 m",
    "link_mount": "0.25, 0 m", "mid_stroke_at": "0.1 rad", "mass": "20 kg", "length": "0.5 m", "spool_diameter": "6",
    "port_shares": "1 1 0.8 0.8", "supply": "pump", "supply_pressure": "120 bar", "displacement": "30 cm^3/rev",
}  # fmt: skip
SLIDE = {
    "moves": "slide", "bore": "25", "rod": "16", "stroke": "300", "mass": "8", "rated_flow": "24 l/min",
    "rated_drop": "5 bar", "supply": "constant", "supply_pressure": "6 MPa",
}  # fmt: skip
