"""The sections of the reports of studies, runs and campaigns: one file for each section or two."""
