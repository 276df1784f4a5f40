"""Studies: many variants of a case, and the value at which a case fails."""
