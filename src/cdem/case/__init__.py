"""The case: a user's input, read from a file or built in Python, and checked."""
