"""``python -m cdem`` runs the program ``cdem``."""

from cdem.cli import main

if __name__ == "__main__":
    main()
