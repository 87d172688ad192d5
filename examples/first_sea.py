"""The sea as Python has it: a scene, a frame, and the heights of a patch in a numpy array.

PYTHONPATH=build/release/python /usr/bin/python3 examples/first_sea.py
"""

import pelagic

scene = pelagic.Scene()
scene.sea.wind_speed_mps = 14.0
rest, quads = pelagic.patch(200.0, 256)

frame = pelagic.Frame(pelagic.Sea(scene))
for t_s in (0.0, 0.5, 1.0):
    frame.set(t_s)
    height = frame.evaluate(rest, outputs=("position",))["position"][:, 2]
    print(f"{t_s} s: {len(rest)} vertices, from {height.min():+.2f} to {height.max():+.2f} m")
