"""What an installation can do: its speed, and what works on this machine."""
