"""Makes the bodies of some shots: a fishing trawler, a navigation buoy, a lighthouse on its rock and a sailing boat.

    python3 examples/object-meshes.py DIR

Makes trawler, buoy, lighthouse and sailboat .obj and .mtl in that folder (the shots have them in examples/data): metres, z up and 0 at
the waterline, bow along +x, closed parts, normals outwards.
"""

import math
import random
import sys
from pathlib import Path

# Linear Rec. 709: colour, roughness, light.
PAINTS = {
    "hull": ((0.020, 0.075, 0.160), 0.35), "boot-topping": ((0.75, 0.75, 0.72), 0.4), "antifouling": ((0.22, 0.035, 0.022), 0.65),
    "rail": ((0.24, 0.12, 0.05), 0.5), "deck": ((0.13, 0.16, 0.14), 0.8), "house": ((0.80, 0.79, 0.75), 0.4),
    "trim": ((0.62, 0.20, 0.03), 0.4), "glass": ((0.012, 0.016, 0.020), 0.08), "mast": ((0.70, 0.52, 0.16), 0.45),
    "steel": ((0.20, 0.20, 0.20), 0.5), "dark": ((0.03, 0.03, 0.03), 0.6), "net": ((0.03, 0.16, 0.11), 0.9),
    "lamp": ((0.9, 0.85, 0.7), 0.3, (1.0, 0.86, 0.6)), "port light": ((0.7, 0.05, 0.04), 0.3, (0.5, 0.02, 0.01)),
    "starboard light": ((0.05, 0.5, 0.15), 0.3, (0.02, 0.4, 0.12)), "red": ((0.55, 0.025, 0.018), 0.45),
    "white": ((0.82, 0.81, 0.78), 0.5), "rock": ((0.12, 0.11, 0.095), 0.9), "wet rock": ((0.035, 0.034, 0.028), 0.5),
    "gallery": ((0.05, 0.06, 0.055), 0.5), "topsides": ((0.80, 0.79, 0.75), 0.25), "teak": ((0.30, 0.19, 0.10), 0.8),
    "sail": ((0.82, 0.79, 0.72), 0.9), "sail's edge": ((0.03, 0.07, 0.16), 0.9), "alloy": ((0.50, 0.50, 0.50), 0.35),
    "wire": ((0.25, 0.25, 0.25), 0.4), "oilskin": ((0.60, 0.12, 0.03), 0.7), "skin": ((0.45, 0.26, 0.17), 0.7),
}


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a) if length > 1e-12 else (0.0, 0.0, 0.0)


def mix(a, b, t):
    return a + (b - a) * t


class Body:
    SMOOTH = math.cos(math.radians(50.0))

    def __init__(self, name):
        self.name, self.points, self.faces = name, [], []

    def add(self, points):
        first = len(self.points)
        self.points += points
        return list(range(first, len(self.points)))

    def face(self, corners, paint):
        """Corners of one place count once: a quad of a tip is a triangle."""
        kept = [c for i, c in enumerate(corners) if math.dist(self.points[c], self.points[corners[i - 1]]) > 1e-9]
        if len(kept) > 2:
            self.faces.append((kept, paint))

    def loft(self, rings, paint, caps=True):
        """Rings of as many points each, counter-clockwise seen from where the rings go. paint: a name, or of (ring, point)."""
        name = paint if callable(paint) else lambda ring, point: paint
        placed = [self.add(ring) for ring in rings]
        for i, (a, b) in enumerate(zip(placed, placed[1:])):
            for k in range(len(a)):
                n = (k + 1) % len(a)
                self.face([a[k], a[n], b[n], b[k]], name(i, k))
        if caps:
            self.face(placed[0][::-1], name(0, 0))
            self.face(placed[-1], name(len(rings) - 2, 0))

    def box(self, low, high, paint, bevel=0.03, rake=0.0):
        """rake: how far the top stands back at the front, a metre of height."""
        bevel = min([bevel] + [0.4 * (h - l) for l, h in zip(low, high)])

        def ring(z, inset):
            x0, x1, y0, y1 = low[0] + inset, high[0] - inset - rake * (z - low[2]), low[1] + inset, high[1] - inset
            b = bevel
            return [(x1, y0 + b, z), (x1, y1 - b, z), (x1 - b, y1, z), (x0 + b, y1, z), (x0, y1 - b, z), (x0, y0 + b, z),
                    (x0 + b, y0, z), (x1 - b, y0, z)]

        self.loft([ring(low[2], bevel), ring(low[2] + bevel, 0.0), ring(high[2] - bevel, 0.0), ring(high[2], bevel)], paint)

    def tube(self, start, end, radius, paint, sides=10, end_radius=None):
        way = unit(minus(end, start))
        side = unit(cross((0.0, 0.0, 1.0) if abs(way[2]) < 0.9 else (1.0, 0.0, 0.0), way))
        other = cross(way, side)

        def ring(at, r):
            return [tuple(at[i] + r * (math.cos(a) * side[i] + math.sin(a) * other[i]) for i in range(3))
                    for a in (2 * math.pi * k / sides for k in range(sides))]

        self.loft([ring(start, radius), ring(end, radius if end_radius is None else end_radius)], paint)

    def lathe(self, profile, paint, sides=24, at=(0.0, 0.0), wobble=None):
        """profile: (radius, z) from below; paint: a name, or of the profile's part."""
        rings = [[(at[0] + r * math.cos(a), at[1] + r * math.sin(a), z) if wobble is None else wobble(r, z, a)
                  for a in (2 * math.pi * k / sides for k in range(sides))] for r, z in profile]
        self.loft(rings, paint if isinstance(paint, str) else lambda part, _: paint(part), caps=profile[0] != profile[-1])

    def write(self, folder):
        normals = [unit(tuple(map(sum, zip(*(cross(minus(self.points[f[i]], self.points[f[0]]), minus(self.points[f[i + 1]], self.points[f[0]]))
                                             for i in range(1, len(f) - 1)))))) for f, _ in self.faces]
        beside = {}
        for number, (corners, _) in enumerate(self.faces):
            for corner in corners:
                beside.setdefault(corner, []).append(number)
        lines, known, paint_now = [], {}, None
        faces = []
        for number, (corners, paint) in sorted(enumerate(self.faces), key=lambda each: (list(PAINTS).index(each[1][1]), each[0])):
            if paint != paint_now:
                faces.append(f"usemtl {paint}")
                paint_now = paint
            words = []
            for corner in corners:
                near = [normals[n] for n in beside[corner] if sum(a * b for a, b in zip(normals[n], normals[number])) > self.SMOOTH]
                normal = tuple(round(x, 4) + 0.0 for x in unit(tuple(map(sum, zip(*near)))))
                words.append(f"{corner + 1}//{known.setdefault(normal, len(known) + 1)}")
            faces.append("f " + " ".join(words))
        lines += ["# Made by examples/object-meshes.py: metres, z up, 0 at the waterline, bow along +x.", f"mtllib {self.name}.mtl", f"o {self.name}"]
        lines += ["v " + " ".join(f"{x:.4f}".rstrip("0").rstrip(".") for x in p) for p in self.points]
        lines += ["vn " + " ".join(f"{x:g}" for x in n) for n in known]
        (folder / f"{self.name}.obj").write_text("\n".join(lines + faces) + "\n", encoding="utf-8")
        paints = []
        for name in PAINTS:
            if any(paint == name for _, paint in self.faces):
                colour, roughness, *light = PAINTS[name]
                paints += [f"newmtl {name}", "Kd {} {} {}".format(*colour), f"Pr {roughness}"] + ["Ke {} {} {}".format(*each) for each in light]
        (folder / f"{self.name}.mtl").write_text("\n".join(paints) + "\n", encoding="utf-8")


# ---- A trawler: 26 m long, 7.5 m wide, 3 m deep in the water

LENGTH, BEAM, DRAUGHT = 26.0, 7.5, 3.0
RAIL = 1.0  # over the deck


def deck_height(x):
    u = x / LENGTH + 0.5
    return 1.25 + 1.75 * max(0.0, (u - 0.35) / 0.65) ** 2.2 + 0.35 * max(0.0, (0.35 - u) / 0.35) ** 2


def half_beam(x, height):
    """height: 0 at the waterline, 1 at the rail: fuller above, above all ahead."""
    u = x / LENGTH + 0.5
    low = 1.0 - max(0.0, (u - 0.42) / 0.58) ** 2.1 - 0.30 * max(0.0, (0.42 - u) / 0.42) ** 2
    high = 1.0 - max(0.0, (u - 0.58) / 0.42) ** 3.0 - 0.12 * max(0.0, (0.42 - u) / 0.42) ** 2
    return max(0.03, BEAM / 2 * mix(low, high, height ** 1.4))


def keel(x):
    u = x / LENGTH + 0.5
    return -DRAUGHT * (1.0 - 0.62 * max(0.0, (0.2 - u) / 0.2) ** 1.5 - 0.75 * max(0.0, (u - 0.72) / 0.28) ** 3)


def section(x, filled):
    """A loop round the hull at x, from the keel up the port side over the bulwark to the deck's middle, and back. filled: up to the
    rail."""
    deck, bottom = deck_height(x), keel(x)
    top = deck + RAIL
    stem = max(0.0, x / (LENGTH / 2)) ** 4 * 0.16  # it leans ahead

    def at(y, z):
        return (x + stem * (z - top), y, z)

    wide = half_beam(x, 0.0)
    side = [at(0.0, bottom), at(min(0.16, 0.5 * wide), bottom), at(0.50 * wide, bottom * 0.90), at(0.80 * wide, bottom * 0.70), at(0.95 * wide, bottom * 0.40),
            at(wide, 0.0)]
    side += [at(half_beam(x, z / top), z) for z in (0.28, mix(0.28, deck, 0.5), deck, mix(deck, top, 0.93))]
    edge = half_beam(x, 1.0)
    side += [at(edge + 0.05, top - 0.05), at(edge + 0.05, top), at(max(edge - 0.17, 0.012), top)]
    inner = max(edge - 0.15, 0.008) if filled else max(min(edge - 0.15, half_beam(x, deck / top) - 0.12), 0.008)
    side += [at(inner, top if filled else deck), at(0.0, top if filled else deck + 0.08)]
    return side + [(px, -py, pz) for px, py, pz in side[-2:0:-1]]


def trawler():
    ship = Body("trawler")
    half = LENGTH / 2
    stations = [(-half, True), (-half + 0.2, True), (-half + 0.2, False)]
    stations += [(x, False) for x in (-12.0, -10.5, -8.5, -6.0, -3.0, 0.0, 3.0, 5.5, 7.5, 9.0, 10.2, 11.2, 12.0)]
    stations += [(12.0, True), (12.5, True), (12.85, True), (half, True)]
    names = ["antifouling"] * 5 + ["boot-topping"] + ["hull"] * 3 + ["rail"] * 3 + ["house", "deck"]

    def paint(ring, point):
        k = point if point < 14 else 27 - point
        return "rail" if stations[ring][1] and stations[ring + 1][1] and k >= 12 else names[k]

    ship.loft([section(*station) for station in stations], paint, caps=False)
    stern = ship.add(section(*stations[0]))
    ship.face([stern[k] for k in (0, 1, 2, 3, 4, 5, 23, 24, 25, 26, 27)][::-1], "antifouling")
    ship.face([stern[k] for k in (5, 6, 22, 23)][::-1], "boot-topping")
    ship.face([stern[k] for k in (6, 7, 8, 9, 19, 20, 21, 22)][::-1], "hull")
    ship.face([stern[k] for k in (*range(9, 20),)][::-1], "rail")
    bow = ship.add(section(*stations[-1]))
    ship.face(bow, "hull")

    # The house, the wheelhouse on it, and what stands on its roof.
    floor = deck_height(2.0) - 0.1
    ship.box((0.2, -2.45, floor), (8.0, 2.45, floor + 2.6), "house", 0.12, rake=0.06)
    ship.box((0.0, -2.6, floor + 2.55), (8.15, 2.6, floor + 2.70), "trim", 0.05)
    low = floor + 2.68
    ship.box((2.4, -2.1, low), (6.9, 2.1, low + 2.3), "house", 0.14, rake=-0.10)
    ship.box((2.1, -2.35, low + 2.25), (7.5, 2.35, low + 2.45), "trim", 0.07)
    for k in range(5):  # panes stand 2 cm out: the front leans ahead
        y = (k - 2) * 0.78
        ring = [(6.9 + 0.10 * z + out, y + side * 0.33, low + z) for out in (-0.05, 0.025) for side, z in
                ((-1, 1.05), (1, 1.05), (1, 1.95), (-1, 1.95))]
        ship.loft([ring[:4], ring[4:]], "glass")
    for side in (-1, 1):
        for k in range(4):
            x = 3.05 + k * 1.0
            ship.box((x - 0.38, min(2.05 * side, 2.125 * side), low + 1.05), (x + 0.38, max(2.05 * side, 2.125 * side), low + 1.95), "glass", 0.02)
        for x in (1.3, 2.9, 6.3):
            ship.tube((x, 2.40 * side, floor + 1.55), (x, 2.475 * side, floor + 1.55), 0.24, "glass", 14)
            ship.tube((x, 2.40 * side, floor + 1.55), (x, 2.465 * side, floor + 1.55), 0.30, "steel", 14)
        ship.box((4.2, min(2.4 * side, 2.49 * side), floor + 0.15), (5.05, max(2.4 * side, 2.49 * side), floor + 2.1), "trim", 0.03)
        ship.box((6.0, 2.12 * side - 0.16, low + 2.45), (6.5, 2.12 * side + 0.16, low + 2.75), "dark", 0.03)
        ship.tube((6.5, 2.12 * side, low + 2.6), (6.62, 2.12 * side, low + 2.6), 0.1, "port light" if side > 0 else "starboard light")
    for y in (-1.1, 1.1):
        ship.box((2.33, y - 0.45, low + 1.05), (2.42, y + 0.45, low + 1.95), "glass", 0.02)
    ship.box((0.15, -0.45, floor + 0.15), (0.25, 0.45, floor + 2.1), "trim", 0.03)
    ship.box((0.7, -0.55, floor + 2.68), (1.9, 0.55, floor + 4.9), "trim", 0.18, rake=0.12)  # the funnel
    ship.box((0.75, -0.5, floor + 4.85), (1.55, 0.5, floor + 5.05), "dark", 0.08)
    roof = low + 2.4
    ship.tube((4.3, 0.0, roof), (4.3, 0.0, roof + 4.6), 0.13, "mast", 12, 0.07)
    ship.tube((4.3, -1.1, roof + 3.0), (4.3, 1.1, roof + 3.0), 0.05, "mast", 8)
    for y in (-0.9, 0.9):
        ship.tube((4.3, y, roof + 3.0), (4.3, y, roof + 4.3), 0.02, "steel", 6)
    ship.tube((4.3, 0.0, roof + 1.55), (4.85, 0.0, roof + 1.55), 0.05, "mast", 8)
    ship.tube((4.85, 0.0, roof + 1.5), (4.85, 0.0, roof + 1.72), 0.12, "house", 12)
    ship.box((4.75, -0.95, roof + 1.72), (4.95, 0.95, roof + 1.90), "house", 0.05)  # the radar
    ship.lathe([(0.001, roof + 4.6), (0.13, roof + 4.6), (0.15, roof + 4.68), (0.15, roof + 4.92), (0.09, roof + 5.02), (0.001, roof + 5.04)], "lamp", 14,
               (4.3, 0.0))
    ship.lathe([(0.001, roof), (0.22, roof), (0.36, roof + 0.2), (0.36, roof + 0.45), (0.2, roof + 0.68), (0.001, roof + 0.75)], "house", 16, (2.9, 1.4))
    for side in (-1, 1):  # lamps over the working deck
        ship.box((1.98, side * 1.7 - 0.16, low + 2.02), (2.10, side * 1.7 + 0.16, low + 2.24), "lamp", 0.02)

    # The working deck: hatch, winch, net drum, gantry, and a derrick.
    aft = deck_height(-5.0) + 0.02
    ship.box((-5.6, -1.3, aft), (-3.4, 1.3, aft + 0.65), "deck", 0.07)
    ship.box((-5.75, -1.45, aft + 0.6), (-3.25, 1.45, aft + 0.75), "steel", 0.05)
    for y in (-1.35, 0.35):
        ship.tube((-1.6, y, aft + 0.75), (-1.6, y + 1.0, aft + 0.75), 0.42, "steel", 16)
        for disc in (y, y + 1.0):
            ship.tube((-1.6, disc - 0.05, aft + 0.75), (-1.6, disc + 0.05, aft + 0.75), 0.68, "dark", 18)
    ship.box((-2.1, -1.7, aft), (-1.1, 1.7, aft + 0.3), "steel", 0.05)
    drum = deck_height(-10.0) + 1.15
    ship.tube((-9.6, -1.6, drum), (-9.6, 1.6, drum), 0.72, "net", 18)
    for y in (-1.68, 1.68):
        ship.tube((-9.6, y - 0.06, drum), (-9.6, y + 0.06, drum), 1.0, "trim", 20)
        ship.box((-9.9, y - 0.13 if y < 0 else y + 0.06, drum - 1.2), (-9.3, y - 0.06 if y < 0 else y + 0.13, drum + 0.1), "steel", 0.02)
    for side in (-1, 1):
        foot = (-11.9, side * 2.55, deck_height(-11.9))
        ship.tube(foot, (-12.1, side * 2.0, foot[2] + 5.2), 0.17, "mast", 12)
        ship.tube((-10.6, side * 2.6, deck_height(-10.6)), (-12.05, side * 2.05, foot[2] + 4.6), 0.11, "mast", 10)
        ship.tube((-12.1, side * 1.2, foot[2] + 5.0), (-12.1, side * 1.2, foot[2] + 4.4), 0.14, "dark", 10)
        ship.box((-12.35, side * 2.9 - 0.09, deck_height(-12.3) - 0.1), (-11.1, side * 2.9 + 0.09, deck_height(-12.3) + 1.7), "steel", 0.05)  # trawl doors
    ship.tube((-12.1, -2.3, foot[2] + 5.15), (-12.1, 2.3, foot[2] + 5.15), 0.17, "mast", 12)
    ship.tube((0.0, 0.0, aft), (0.0, 0.0, aft + 7.2), 0.16, "mast", 12, 0.1)
    ship.tube((0.0, 0.0, aft + 2.9), (-7.2, 0.0, aft + 6.0), 0.10, "mast", 10, 0.06)
    ship.tube((0.0, 0.0, aft + 7.0), (-7.1, 0.0, aft + 5.98), 0.02, "dark", 6)
    # Ahead: windlass, bollards and a rail on the bulwark.
    bow_deck = deck_height(10.2) + 0.05
    ship.tube((10.0, -0.8, bow_deck + 0.45), (10.0, 0.8, bow_deck + 0.45), 0.26, "dark", 14)
    ship.box((9.75, -0.35, bow_deck - 0.1), (10.3, 0.35, bow_deck + 0.7), "steel", 0.06)
    for x in (-7.2, 8.2):
        for side in (-1, 1):
            for gap in (-0.25, 0.25):
                y = side * (half_beam(x + 0.25, 0.7) - 0.4)
                ship.tube((x + gap, y, deck_height(x) - 0.1), (x + gap, y, deck_height(x) + 0.55), 0.1, "dark", 10)
    return ship


def buoy():
    """A port-hand light buoy: 2.5 m wide, 4 m tall over the water."""
    body = Body("buoy")
    body.lathe([(0.001, -1.1), (0.55, -1.1), (0.62, -1.04), (0.62, -0.75), (1.13, -0.45), (1.22, -0.36), (1.25, -0.1), (1.25, 0.32), (1.21, 0.42), (1.0, 0.52),
                (0.4, 0.56), (0.001, 0.56)], lambda part: "antifouling" if part < 6 else "red", 32)
    body.lathe([(1.25, 0.08), (1.31, 0.09), (1.33, 0.14), (1.33, 0.22), (1.31, 0.27), (1.25, 0.28), (1.2, 0.18), (1.25, 0.08)], "dark", 32)
    for k in range(4):
        a = math.pi / 4 + k * math.pi / 2
        c, s = math.cos(a), math.sin(a)
        body.tube((0.80 * c, 0.80 * s, 0.5), (0.36 * c, 0.36 * s, 2.85), 0.055, "red", 10)
        n = a + math.pi / 2
        for z in (1.25, 2.1):
            r = mix(0.80, 0.36, (z - 0.5) / 2.35)
            body.tube((r * c, r * s, z), (r * math.cos(n), r * math.sin(n), z), 0.032, "red", 8)
        body.tube((1.05 * c, 1.05 * s, 0.48), (1.05 * c, 1.05 * s, 0.66), 0.07, "steel", 10)
    body.box((-0.26, -0.26, 1.3), (0.26, 0.26, 2.05), "red", 0.05)
    body.lathe([(0.001, 2.82), (0.46, 2.82), (0.48, 2.85), (0.48, 2.92), (0.46, 2.95), (0.001, 2.95)], "red", 24)
    body.lathe([(0.001, 2.94), (0.24, 2.94), (0.26, 2.97), (0.26, 3.08), (0.20, 3.12), (0.001, 3.12)], "dark", 20)
    body.lathe([(0.001, 3.11), (0.17, 3.11), (0.185, 3.15), (0.185, 3.38), (0.16, 3.44), (0.001, 3.46)], "lamp", 20)
    body.tube((0.36, 0.0, 2.94), (0.36, 0.0, 3.62), 0.025, "steel", 8)
    body.tube((-0.36, 0.0, 2.94), (-0.36, 0.0, 3.62), 0.025, "steel", 8)
    body.tube((-0.36, 0.0, 3.6), (0.36, 0.0, 3.6), 0.025, "steel", 8)
    body.lathe([(0.001, 3.6), (0.22, 3.6), (0.24, 3.62), (0.24, 3.98), (0.22, 4.0), (0.001, 4.0)], "red", 24)  # the can on top
    return body


def lighthouse():
    """A tower of 20 m on a rock that reaches 8 m below the water."""
    body = Body("lighthouse")
    draw = random.Random(3)
    waves = [(draw.uniform(1, 9), draw.uniform(0, 2 * math.pi), draw.uniform(-1.4, 1.4)) for _ in range(14)]

    def rough(r, z, a):
        """A closed sum of waves round the rock, more of it outside; it steps where layers end."""
        if r < 0.5:
            return (r * math.cos(a), r * math.sin(a), z)
        sum_ = sum(math.sin(round(n) * a + phase + lean * z) / (1.0 + 0.35 * round(n)) for n, phase, lean in waves)
        out = r * (1.0 + 0.085 * sum_) + 0.5 * math.sin(2.3 * z + 3.0 * math.sin(a))
        up = 0.28 * math.sin(3 * a + 1.7 * z) * min(1.0, r / 6.0) * (z < 4.4)
        crag = min(1.0, max(0.0, (r - 4.2) / 1.5)) * (z > -6.0)
        out += crag * draw.uniform(-0.55, 0.55)
        return (1.35 * out * math.cos(a), out * math.sin(a), z + up + crag * draw.uniform(-0.22, 0.22))

    profile = [(0.001, -8.0), (13.0, -8.0), (12.2, -5.5), (11.4, -3.0), (10.6, -1.6), (10.0, -0.6), (9.6, 0.2), (9.0, 0.8), (8.3, 1.25), (7.9, 2.0), (7.0, 2.6),
               (6.4, 3.3), (5.6, 3.7), (5.0, 4.3), (4.2, 4.5), (0.001, 4.6)]
    body.lathe(profile, lambda part: "wet rock" if part < 7 else "rock", 56, wobble=rough)
    body.lathe([(0.001, 4.0), (3.6, 4.0), (3.6, 5.0), (3.5, 5.12), (2.9, 5.15), (0.001, 5.15)], "white", 40)
    foot, top, low, high = 2.35, 1.55, 5.1, 20.0
    bands = 5
    profile, paints = [(0.001, low)], ["white"]
    for band in range(bands):
        for t in (0.0, 0.5, 0.999):
            u = (band + t) / bands
            profile.append((mix(foot, top, u ** 0.8) , mix(low, high, u)))
            paints.append("red" if band % 2 else "white")
    profile += [(top, high), (0.001, high)]
    paints += ["white", "white"]
    body.lathe(profile, lambda part: paints[part], 40)
    body.lathe([(1.5, 19.1), (1.95, 19.75), (2.35, 19.95), (2.35, 20.15), (2.3, 20.2), (0.001, 20.2), (0.001, 19.1), (1.5, 19.1)], "gallery", 40)
    for k in range(20):
        a = 2 * math.pi * k / 20
        body.tube((2.22 * math.cos(a), 2.22 * math.sin(a), 20.15), (2.22 * math.cos(a), 2.22 * math.sin(a), 21.2), 0.03, "gallery", 6)
    for z in (20.7, 21.2):
        body.lathe([(2.19, z), (2.22, z - 0.03), (2.25, z), (2.22, z + 0.03), (2.19, z)], "gallery", 40)
    body.lathe([(0.001, 20.15), (1.2, 20.15), (1.2, 20.95), (1.14, 21.0), (0.001, 21.0)], "white", 32)
    body.lathe([(0.001, 21.0), (0.62, 21.0), (0.75, 21.3), (0.75, 22.2), (0.62, 22.5), (0.001, 22.5)], "lamp", 24)  # the lens
    for k in range(12):
        a = 2 * math.pi * k / 12
        body.tube((1.12 * math.cos(a), 1.12 * math.sin(a), 20.95), (1.12 * math.cos(a), 1.12 * math.sin(a), 22.75), 0.045, "gallery", 6)
    body.lathe([(0.001, 22.7), (1.35, 22.7), (1.4, 22.78), (1.3, 22.9), (0.95, 23.35), (0.45, 23.7), (0.16, 23.8), (0.16, 24.0), (0.1, 24.1), (0.001, 24.12)], "red", 32)
    body.tube((0.0, 0.0, 24.1), (0.0, 0.0, 25.3), 0.03, "steel", 6)
    for z, a in ((8.2, 0.4), (11.3, 2.2), (14.4, 4.0), (17.3, 5.4)):  # windows
        r = mix(foot, top, ((z - low) / (high - low)) ** 0.8)
        c, s = math.cos(a), math.sin(a)
        for size, out, paint in ((0.36, 0.06, "gallery"), (0.27, 0.08, "glass")):
            ring = [[((r + o) * c - y * s, (r + o) * s + y * c, z + h) for y, h in ((-size, -1.5 * size), (size, -1.5 * size), (size, 1.5 * size), (-size, 1.5 * size))]
                    for o in (-0.4, out)]
            body.loft(ring, paint)
    r, a = foot, -0.9
    c, s = math.cos(a), math.sin(a)
    body.loft([[((r + o) * c - y * s, (r + o) * s + y * c, 5.12 + h) for y, h in ((-0.5, 0.0), (0.5, 0.0), (0.5, 2.0), (-0.5, 2.0))] for o in (-0.5, 0.07)], "gallery")
    return body


# A sailing boat: 11 m long, 3.6 m wide, 2 m deep in the water, on the port tack: its sails are to starboard

def sheer(x):
    u = x / 11.0 + 0.5
    return 1.02 + 0.30 * max(0.0, u - 0.35) ** 1.6 + 0.10 * max(0.0, 0.35 - u) ** 1.5


def yacht_beam(x):
    """Half of it, at the sheer."""
    u = x / 11.0 + 0.5
    return max(0.02, 1.80 * (1.0 - max(0.0, (u - 0.42) / 0.58) ** 2.3 - 0.30 * max(0.0, (0.42 - u) / 0.42) ** 2.2))


def yacht_bottom(x):
    """Without the keel: out of the water at the stern, and the stem goes straight up."""
    u = x / 11.0 + 0.5
    return -0.58 * (1.0 - max(0.0, (0.50 - u) / 0.445) ** 2.0 - 0.93 * max(0.0, (u - 0.50) / 0.50) ** 2.3)


def yacht_section(x, floor):
    """A loop as the trawler's. floor: of the cockpit, below the deck; 0 where there is none."""
    top, bottom, wide = sheer(x), yacht_bottom(x), yacht_beam(x)
    stem = max(0.0, x / 5.5) ** 4 * 0.30

    def at(y, z):
        return (x + stem * (z - top), y, z)

    def bilge(z):
        """A superellipse round the middle of the deck."""
        return wide * max(0.0, 1.0 - ((top - z) / (top - bottom)) ** 2.5) ** (1.0 / 2.5)

    boot = max(0.07, bottom + 0.03)
    side = [at(0.0, bottom)] + [at(bilge(z), z) for z in (mix(bottom, boot, t) for t in (0.03, 0.12, 0.3, 0.6, 1.0))]
    side += [at(bilge(z), z) for z in (boot + 0.09, *(mix(boot + 0.09, top, t) for t in (0.3, 0.6, 0.85, 1.0)))]
    inner = max(wide - 0.05, 0.5 * wide)
    side += [at(wide, top + 0.05), at(inner, top + 0.05), at(inner, top)]
    well = min(0.62, 0.5 * inner)
    side += [at(well, top + 0.04), at(well, top + 0.04 - floor), at(0.0, top + 0.06 - floor)]
    return side + [(px, -py, pz) for px, py, pz in side[-2:0:-1]]


def wing(low, high, low_chord, high_chord, thick):
    """Rings of a fin from below upwards: (x of the leading edge, z) of both ends."""
    outline = [(0.0, 0.0), (0.03, 0.35), (0.12, 0.8), (0.3, 1.0), (0.6, 0.72), (0.85, 0.3), (1.0, 0.04)]
    loop = outline + [(c, -h) for c, h in outline[:0:-1]]
    rings = []
    for t in (0.0, 0.04, 0.35, 0.7, 1.0):
        chord = mix(low_chord, high_chord, t) * (0.93 if t == 0.0 else 1.0)
        rings.append([(mix(low[0], high[0], t) - c * chord, -h * 0.5 * thick * chord, mix(low[1], high[1], t)) for c, h in loop])
    return rings


def cloth(body, at, rows, columns, paint, thick=0.016):
    """A sail: at(s, c) up its luff and back along its chord, leeward its bulge. A closed shell: both its sides are seen."""
    def normal(s, c):
        e = 1e-3
        up = minus(at(min(s + e, 1.0), c), at(max(s - e, 0.0), c))
        back = minus(at(s, min(c + e, 1.0)), at(s, max(c - e, 0.0)))
        return unit(cross(up, back))  # to leeward

    grid = [[(i / rows, k / columns) for k in range(columns + 1)] for i in range(rows + 1)]
    sides = []
    for sign in (1.0, -1.0):
        sides.append([body.add([tuple(p + sign * 0.5 * thick * n for p, n in zip(at(s, c), normal(s, c))) for s, c in row]) for row in grid])
    lee, luv = sides
    for i in range(rows):
        for k in range(columns):
            name = paint(i, k)
            body.face([lee[i][k], lee[i + 1][k], lee[i + 1][k + 1], lee[i][k + 1]], name)
            body.face([luv[i][k], luv[i][k + 1], luv[i + 1][k + 1], luv[i + 1][k]], name)
    edge = [(0, k) for k in range(columns)] + [(i, columns) for i in range(rows)]
    edge += [(rows, k) for k in range(columns, 0, -1)] + [(i, 0) for i in range(rows, 0, -1)]
    for (i, k), (j, l) in zip(edge, edge[1:] + edge[:1]):
        body.face([lee[i][k], lee[j][l], luv[j][l], luv[i][k]], paint(min(i, rows - 1), min(k, columns - 1)))


def sailor(body, seat, faces, jacket):
    """One who sits, his knees towards `faces`."""
    x, y, z = seat
    fx, fy = faces

    def turned(a, b, h):
        return (x + a * fx - b * fy, y + a * fy + b * fx, z + h)

    body.loft([[turned(lean + deep * math.cos(a), wide * math.sin(a), h) for a in (2 * math.pi * k / 10 for k in range(10))]
               for lean, deep, wide, h in ((0.0, 0.12, 0.17, 0.0), (0.0, 0.16, 0.21, 0.06), (0.02, 0.14, 0.20, 0.3), (0.03, 0.12, 0.22, 0.48), (0.04, 0.06, 0.09, 0.57))], jacket)
    body.loft([[turned(0.07 + r * math.cos(a), 0.9 * r * math.sin(a), h) for a in (2 * math.pi * k / 10 for k in range(10))]
               for r, h in ((0.04, 0.55), (0.08, 0.60), (0.105, 0.68), (0.095, 0.76), (0.04, 0.82))], "skin")
    for side in (-1, 1):
        body.tube(turned(0.03, 0.21 * side, 0.47), turned(0.20, 0.25 * side, 0.22), 0.055, jacket, 7)
        body.tube(turned(0.20, 0.25 * side, 0.22), turned(0.45, 0.16 * side, 0.26), 0.045, jacket, 7)
        body.tube(turned(0.0, 0.10 * side, 0.06), turned(0.46, 0.13 * side, 0.08), 0.085, "dark", 7)
        body.tube(turned(0.46, 0.13 * side, 0.10), turned(0.50, 0.13 * side, -0.36), 0.065, "dark", 7)


def sailboat():
    boat = Body("sailboat")
    wells = [(-5.5, 0.0), (-5.3, 0.0), (-5.3, 0.42), (-4.4, 0.42), (-3.4, 0.42), (-2.4, 0.42), (-1.5, 0.42), (-1.5, 0.0)]
    stations = wells + [(x, 0.0) for x in (-0.6, 0.4, 1.3, 2.2, 3.0, 3.7, 4.3, 4.8, 5.15, 5.35, 5.5)]
    names = ["antifouling"] * 5 + ["boot-topping"] + ["topsides"] * 4 + ["teak"] * 3 + ["house", "topsides", "teak"]
    rings = [yacht_section(*station) for station in stations]
    boat.loft(rings, lambda ring, point: names[point if point < 16 else 31 - point], caps=False)
    stern = boat.add(rings[0])
    boat.face([stern[k] for k in (0, *range(1, 6), *range(27, 32))][::-1], "antifouling")
    boat.face([stern[k] for k in (*range(5, 28),)][::-1], "topsides")
    boat.face(boat.add(rings[-1]), "topsides")

    boat.loft(wing((0.75, -1.95), (1.10, -0.42), 1.25, 1.85, 0.11), "antifouling")
    boat.loft([[(mix(-0.95, 1.1, t), r * math.cos(a), -1.88 + 0.8 * r * math.sin(a)) for a in (2 * math.pi * k / 12 for k in range(12))]
               for t, r in ((0.0, 0.01), (0.2, 0.10), (0.5, 0.18), (0.8, 0.19), (0.95, 0.12), (1.0, 0.02))], "antifouling")
    boat.loft(wing((-4.35, -1.65), (-4.15, -0.02), 0.42, 0.68, 0.10), "antifouling")

    # The cabin trunk: its sides lean in, its front slopes to the foredeck.
    def trunk(x):
        u = (x + 1.5) / 5.3
        wide = min(1.22, yacht_beam(x) - 0.52) * (1.0 - 0.25 * u ** 3)
        low, rise = sheer(x) - 0.02, 0.50 * max(0.05, 1.0 - max(0.0, (u - 0.55) / 0.45) ** 1.6)
        return wide, low, rise

    def trunk_ring(x):
        wide, low, rise = trunk(x)
        half = [(x, wide, low), (x, wide - 0.13 * rise, low + 0.75 * rise), (x, wide - 0.32 * rise, low + 0.96 * rise), (x, 0.55 * wide, low + 1.06 * rise)]
        return half + [(x, 0.0, low + 1.12 * rise)] + [(px, -py, pz) for px, py, pz in half[::-1]]

    boat.loft([trunk_ring(x) for x in (-1.5, -0.5, 0.5, 1.4, 2.1, 2.7, 3.2, 3.6, 3.8)], "house")

    def pane(x, t, side, out):
        wide, low, rise = trunk(x)
        return (x, side * (wide - 0.13 * rise * t / 0.75 + out), low + t * rise)

    for side in (-1, 1):
        for start, end in ((-1.2, -0.15), (0.05, 1.05), (1.25, 2.1)):
            outline = [(end, 0.24), (start, 0.24), (start, 0.66), (end - 0.12, 0.66)]
            outline = outline if side > 0 else outline[::-1]
            boat.loft([[pane(x, t, side, out) for x, t in outline] for out in (-0.06, 0.012)], "glass")
        boat.tube((-0.9, side * 1.02, sheer(0.0) + 0.52), (2.2, side * 0.82, sheer(2.2) + 0.48), 0.018, "teak", 6)
        boat.box((-4.3, side * 0.80 - 0.17, sheer(-3.0)), (-1.5, side * 0.80 + 0.17, sheer(-3.0) + 0.24), "topsides", 0.06)  # coamings
        for x in (-3.3, -2.0):  # winches
            boat.lathe([(0.001, sheer(x) + 0.2), (0.10, sheer(x) + 0.2), (0.07, sheer(x) + 0.28), (0.07, sheer(x) + 0.36), (0.10, sheer(x) + 0.4), (0.001, sheer(x) + 0.41)],
                       "alloy", 12, (x, side * 0.80))
    roof = sheer(-1.0) + 0.52
    boat.box((-1.54, -0.33, sheer(-1.5) - 0.30), (-1.48, 0.33, roof + 0.02), "dark", 0.01)  # the way down
    boat.box((-1.5, -0.42, roof), (-0.35, 0.42, roof + 0.11), "house", 0.04)
    boat.loft([[(x, y, z) for y, z in ((-1.0, roof - 0.12), (-0.95, roof + 0.28), (-0.6, roof + 0.56), (0.0, roof + 0.64), (0.6, roof + 0.56), (0.95, roof + 0.28), (1.0, roof - 0.12))][::-1]
               for x in (-1.45, -1.0)] + [[(-0.35, y, z) for y, z in ((-0.9, roof - 0.1), (-0.85, roof), (-0.5, roof + 0.02), (0.0, roof + 0.03), (0.5, roof + 0.02),
                                                                    (0.85, roof), (0.9, roof - 0.1))][::-1]], "sail's edge")  # the spray hood
    boat.box((2.35, -0.27, sheer(2.6) + 0.38), (2.9, 0.27, sheer(2.6) + 0.50), "glass", 0.03)

    # The wheel, and two who sail.
    hub = (-3.85, 0.0, sheer(-3.85) + 0.48)
    boat.tube((-3.72, 0.0, sheer(-3.7) - 0.40), (-3.72, 0.0, hub[2] + 0.1), 0.08, "topsides", 10, 0.06)
    boat.tube((-3.72, 0.0, hub[2]), hub, 0.03, "alloy", 6)
    rim = [(hub[0], 0.46 * math.cos(a), hub[2] + 0.46 * math.sin(a)) for a in (2 * math.pi * k / 16 for k in range(16))]
    for a, b in zip(rim, rim[1:] + rim[:1]):
        boat.tube(a, b, 0.018, "alloy", 5)
    for k in range(0, 16, 4):
        boat.tube(hub, rim[k], 0.010, "alloy", 4)
    sailor(boat, (-4.25, 0.78, sheer(-4.2) + 0.22), (0.55, -0.84), "oilskin")
    sailor(boat, (-2.35, 0.86, sheer(-2.4) + 0.22), (0.1, -0.995), "sail's edge")

    # Mast and boom: the mast leans aft, and the boom to starboard.
    foot, head = 1.05, 15.3

    def mast(z):
        return 0.95 - 0.018 * (z - foot)

    def spar(start, end, along, across, paint, end_scale=1.0):
        way = unit(minus(end, start))
        ahead = unit(cross((0.0, 1.0, 0.0), way))
        beside = cross(way, ahead)
        boat.loft([[tuple(p + scale * (along * math.cos(a) * v + across * math.sin(a) * w) for p, v, w in zip(at, ahead, beside)) for a in
                    (2 * math.pi * k / 12 for k in range(12))] for at, scale in ((start, 1.0), (end, end_scale))], paint)

    spar((mast(foot), 0.0, foot), (mast(head), 0.0, head), 0.12, 0.075, "alloy", 0.65)
    goose, out, reach = 2.35, math.radians(17.0), 4.75

    def boom(d):
        return (mast(goose) - 0.10 - d * math.cos(out), -d * math.sin(out), goose + 0.035 * d)

    spar(boom(0.0), boom(reach), 0.085, 0.06, "alloy")
    boat.tube(boom(1.5), (mast(1.5) - 0.1, 0.0, roof + 0.05), 0.022, "alloy", 6)
    boat.tube(boom(3.3), (-2.0, -0.3, sheer(-2.0) + 0.2), 0.016, "wire", 5)
    boat.tube(boom(3.5), (-2.0, 0.3, sheer(-2.0) + 0.2), 0.016, "wire", 5)

    def main(s, c):
        chord = 4.6 * (1.0 - s ** 1.45) + 0.22 * s
        z = mix(goose + 0.12, head - 0.25, s)
        a = out + math.radians(13.0) * s ** 0.8
        bulge = (0.085 + 0.04 * math.sin(math.pi * min(1.0, s + 0.2))) * chord * 6.2 * c * (1.0 - c) * (1.0 - 0.45 * c) / 1.2 * (0.45 + 0.55 * min(1.0, 5.0 * s))
        return (mast(z) - 0.12 - chord * c * math.cos(a) + bulge * math.sin(a), -chord * c * math.sin(a) - bulge * math.cos(a),
                z + 0.035 * chord * c * (1.0 - s) - 0.02 * chord * c * s)

    cloth(boat, main, 20, 12, lambda i, k: "sail")
    for s, width in ((0.22, 1.0), (0.42, 1.0), (0.62, 1.0), (0.82, 1.0)):  # battens
        line = [main(s, mix(1.0 - 0.55 * width, 0.995, k / 4)) for k in range(5)]
        for a, b in zip(line, line[1:]):
            boat.tube(a, b, 0.022, "sail", 4)

    tack, halyard = (5.18, 0.0, 1.62), (mast(14.6) + 0.12, 0.0, 14.6)
    clew = (0.10, -1.52, 2.0)

    def genoa(s, c):
        luff = tuple(mix(a, b, s) for a, b in zip(tack, halyard))
        leech = [mix(a, b, s) for a, b in zip(clew, halyard)]
        leech[1] -= 1.0 * s * (1.0 - s) ** 0.8  # it twists off
        leech[0] += 0.30 * 4.0 * s * (1.0 - s)  # and is hollow
        chord = math.dist(luff, leech)
        way = unit((leech[0] - luff[0], leech[1] - luff[1], 0.0))
        bulge = 0.135 * chord * 6.75 * c * (1.0 - c) ** 1.6 / 1.31 * (0.55 + 0.45 * min(1.0, 4.0 * s))
        foot_round = -0.22 * 4.0 * c * (1.0 - c) * max(0.0, 1.0 - 5.0 * s)
        x, y, z = (mix(a, b, c) for a, b in zip(luff, leech))
        return (x - way[1] * bulge * -1.0, y - abs(way[0]) * bulge, z + foot_round)

    cloth(boat, genoa, 20, 12, lambda i, k: "sail's edge" if k == 11 or i == 0 else "sail")

    def wire(*points, radius=0.011):
        for a, b in zip(points, points[1:]):
            boat.tube(a, b, radius, "wire", 5)

    wire((5.32, 0.0, sheer(5.3) + 0.04), (mast(14.85) + 0.1, 0.0, 14.85), radius=0.022)
    boat.tube((5.28, 0.0, sheer(5.3) + 0.08), (5.24, 0.0, sheer(5.3) + 0.24), 0.09, "dark", 10)
    masthead = (mast(head) - 0.08, 0.0, head - 0.05)
    wire(masthead, (-4.4, 0.0, 3.6))
    for side in (-1, 1):
        wire((-4.4, 0.0, 3.6), (-5.35, side * 1.0, sheer(-5.4) + 0.05))
        plate = (0.70, side * 1.66, sheer(0.7) + 0.03)
        tips = []
        for z, reach_out in ((6.0, 1.18), (10.6, 0.86)):
            tip = (mast(z) - 0.28 * reach_out, side * reach_out, z + 0.06)
            boat.tube((mast(z), 0.0, z), tip, 0.032, "alloy", 6, 0.022)
            tips.append(tip)
        wire(plate, tips[0], tips[1], (mast(head), side * 0.05, head - 0.1))
        wire((0.85, side * 1.60, sheer(0.85) + 0.03), (mast(5.9), side * 0.05, 5.9))
        wire(tips[0], (mast(10.5), side * 0.05, 10.5))
        # The rail: pulpit, stanchions with two lines, pushpit.
        posts = [(x, side * (yacht_beam(x) - 0.07), sheer(x)) for x in (4.65, 3.4, 2.0, 0.5, -1.1, -2.7, -4.3)]
        for x, y, z in posts:
            boat.tube((x, y, z), (x, y, z + 0.62), 0.014, "alloy", 6)
        for up in (0.33, 0.61):
            wire(*[(x, y, z + up) for x, y, z in posts], radius=0.008)
        bow, quarter = (5.48, side * 0.10, sheer(5.5) + 0.64), (-5.38, side * (yacht_beam(-5.4) - 0.08), sheer(-5.4))
        boat.tube((posts[0][0], posts[0][1], posts[0][2] + 0.62), bow, 0.016, "alloy", 6)
        boat.tube((5.3, side * 0.06, sheer(5.3)), bow, 0.016, "alloy", 6)
        boat.tube(quarter, (quarter[0], quarter[1], quarter[2] + 0.62), 0.016, "alloy", 6)
        for up in (0.33, 0.61):
            boat.tube((posts[-1][0], posts[-1][1], posts[-1][2] + up), (quarter[0], quarter[1], quarter[2] + up), 0.014, "alloy", 6)
            boat.tube((quarter[0], quarter[1], quarter[2] + up), (quarter[0], side * 0.35, quarter[2] + up), 0.014, "alloy", 6)
        boat.tube((quarter[0], side * 0.35, quarter[2]), (quarter[0], side * 0.35, quarter[2] + 0.62), 0.014, "alloy", 6)
    boat.tube((5.48, -0.10, sheer(5.5) + 0.64), (5.48, 0.10, sheer(5.5) + 0.64), 0.016, "alloy", 6)
    wire(clew, (-1.6, -1.30, sheer(-1.6) + 0.08), (-3.3, -0.80, sheer(-3.3) + 0.3), radius=0.014)  # the genoa's sheet
    boat.tube((mast(head), 0.0, head), (mast(head), 0.0, head + 0.75), 0.008, "wire", 5)
    boat.tube((mast(head) + 0.12, 0.0, head), (mast(head) + 0.12, 0.0, head + 0.14), 0.05, "dark", 8)
    return boat


if __name__ == "__main__":
    for made in (trawler(), buoy(), lighthouse(), sailboat()):
        made.write(Path(sys.argv[1]))
