"""The water at a buoy, in four lines of Python: a shot, a frame of its sea, a time, a place. And at a thousand floats.

PYTHONPATH=build/release/python /usr/bin/python3 examples/first_sea.py
"""

import pathlib

import numpy as np
import pelagic

scene = pelagic.Scene.from_file(pathlib.Path(__file__).with_name("first-shot.toml"))
frame = pelagic.Frame(pelagic.Sea(scene))
frame.set(3.0)  # seconds
water = frame.heights([(3.0, -8.0)])  # metres: x east, y north

height_m, normal, velocity = water["height_m"][0], water["normal"][0], water["velocity"][0]
print(f"{height_m:+.2f} m high, tilted by {1.0 - normal[2]:.2f}, rising at {velocity[2]:+.2f} m/s")
floats = frame.heights(np.random.default_rng(1).uniform(-200.0, 200.0, (1000, 2)))["height_m"]
print(f"{len(floats)} floats, from {floats.min():+.2f} to {floats.max():+.2f} m")
