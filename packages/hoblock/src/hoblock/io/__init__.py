"""Files in and out, one format a module. Nothing is imported here: take what you need from its module."""
