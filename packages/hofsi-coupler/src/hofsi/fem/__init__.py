"""Finite elements on batches of quadrilaterals: spaces, geometry factors, constraints, condensation."""
