"""Discretised fields: solver → step → state."""
