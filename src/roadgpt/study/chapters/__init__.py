"""Makes the sections of a study's report, one file each. A section takes values and returns a Section."""
