"""Long runs: memory must stay flat and the energy closed.

`small`: a cube that slides down a slope and rocks against a wall, 10 million steps; `landslide`: the
template of `cdem new landslide`, 100,000 steps.
"""
