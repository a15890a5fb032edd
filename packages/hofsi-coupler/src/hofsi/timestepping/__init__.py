"""Time integration: coefficients of schemes."""
