"""Searches of the unit cube behind one interface: `search`."""

from hydrolek_drake.identification.search.search import METHODS, SearchResult, search

__all__ = ["METHODS", "SearchResult", "search"]
