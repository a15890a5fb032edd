"""Strong partitioned coupling of a fluid and a solid."""
