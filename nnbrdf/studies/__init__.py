"""The paper's experiment, and others like it: many small trainings, compared in one table."""
