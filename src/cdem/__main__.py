"""``python -m cdem`` does what the program ``cdem`` does."""

from cdem.cli import main

if __name__ == "__main__":
    main()
