"""Signals of earthquakes and blasts: files, processing, measures, response of layered ground."""
