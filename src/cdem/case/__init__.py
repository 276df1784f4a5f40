"""The case: what a user asks for, read from a file or built in Python, and checked."""
