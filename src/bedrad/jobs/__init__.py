"""Jobs: a checked TOML file in, one results file out."""
