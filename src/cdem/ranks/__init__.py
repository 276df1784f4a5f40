"""A model shared out to ranks: what each keeps of it, and how the whole is put together again."""
