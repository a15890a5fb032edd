"""Exact flows on meshes that move, to observe the order of convergence."""
