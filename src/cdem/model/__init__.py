"""From a case to a model that the core can run, and a report on it."""
