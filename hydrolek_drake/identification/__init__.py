"""Identification: from recordings to parameters, with honest uncertainties."""
