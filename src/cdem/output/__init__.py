"""Looking at results: text, plots, pictures, run-out, files for other programs."""
