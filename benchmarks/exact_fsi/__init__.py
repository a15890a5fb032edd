"""Exact solutions of fluid–structure interaction as scenes, to observe the order of convergence."""
