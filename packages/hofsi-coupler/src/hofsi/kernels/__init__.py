"""Element integrals: functions of arrays, without objects and without state."""
