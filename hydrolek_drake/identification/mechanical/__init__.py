"""The mechanical model of thesis section 4.5: the arm alone, its hydraulics a gain."""
