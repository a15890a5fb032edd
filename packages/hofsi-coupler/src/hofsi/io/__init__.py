"""Files: the only place where hofsi reads TOML."""
