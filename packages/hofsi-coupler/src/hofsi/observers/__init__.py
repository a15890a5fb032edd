"""Observers: they read the records of a run and never steer it."""
