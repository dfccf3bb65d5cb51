"""Makes the sections of the reports on studies, runs and campaigns."""
