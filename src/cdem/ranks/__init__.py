"""A model shared out to ranks: their parts, what they exchange, and the whole again."""
