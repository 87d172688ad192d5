#!/usr/bin/env python3
"""Writes boat.obj, an open boat that floats in the examples' pictures: boat.py > boat.obj

x is forward, y to the left, z up; z = 0 is the water line. The group "dry" is the space inside, where there is no water.
"""
import math

LENGTH, BEAM, DRAFT, FREEBOARD, PLANK = 7.0, 2.1, 0.38, 0.55, 0.05
STATIONS, RIBS = 36, 14
WHITE, RED, WOOD, RAIL = (0.78, 0.77, 0.72), (0.42, 0.05, 0.03), (0.36, 0.20, 0.09), (0.22, 0.10, 0.04)

points, faces = [], {"boat": [], "dry": []}


def point(place, colour):
    points.append((*place, *colour))
    return len(points)


def hull(s, a, inset):
    """s: 0 at the stern ... 1 at the bow; a: -1 on the right rail ... 0 at the keel ... 1 on the left one."""
    taper = math.sin(math.pi * (0.16 + 0.84 * s)) ** 0.55 if s < 1 else 0.0
    half = max(0.5 * BEAM * taper - inset, 0.0)
    rail = FREEBOARD * (1.0 + 0.75 * (2 * s - 0.85) ** 2)          # the sheer rises towards both ends
    keel = -DRAFT * (1.0 - max(0.0, (s - 0.55) / 0.45) ** 3) + 1.6 * inset
    turn = abs(a) ** 1.5                                           # round bilges, flaring sides
    y = math.copysign(half * math.sin(0.5 * math.pi * min(abs(a) * 1.12, 1.0)) * (0.88 + 0.12 * abs(a)), a)
    rake = 0.35 * max(0.0, s - 0.75) / 0.25 * abs(a)               # the stem leans forward
    x = LENGTH * (s - 0.5) * (1.0 - 0.4 * inset) + rake
    return (x, y, keel + (rail - keel) * turn)


def shell(inset, colour_of, group, inside):
    rows = [[point(p, colour_of(p)) for p in (hull(i / STATIONS, 2 * j / RIBS - 1, inset) for j in range(RIBS + 1))]
            for i in range(STATIONS + 1)]
    for i in range(STATIONS):
        for j in range(RIBS):
            quad = [rows[i][j], rows[i][j + 1], rows[i + 1][j + 1], rows[i + 1][j]]
            faces[group].append(quad if inside else quad[::-1])
    return rows


def box(x0, x1, half, z0, z1, colour):
    corner = [point((x, y, z), colour) for x in (x0, x1) for y in (-half, half) for z in (z0, z1)]
    for quad in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
        faces["boat"].append([corner[k] for k in quad])


outer = shell(0.0, lambda p: RED if p[2] < 0.06 else WHITE, "boat", False)
inner = shell(PLANK, lambda p: WOOD, "boat", True)
for side in (0, RIBS):                                             # the rails, and the transom's edge
    for i in range(STATIONS):
        quad = [point(points[k - 1][:3], RAIL)
                for k in (outer[i][side], outer[i + 1][side], inner[i + 1][side], inner[i][side])]
        faces["boat"].append(quad if side == 0 else quad[::-1])
for rows, inside, colour in ((outer, False, WHITE), (inner, True, WOOD)):
    edge = [point(points[k - 1][:3], colour) for k in rows[0]]
    faces["boat"].append(edge if inside else edge[::-1])
for i in range(RIBS):
    faces["boat"].append([outer[0][i], outer[0][i + 1], inner[0][i + 1], inner[0][i]])
for s in (0.2, 0.45, 0.68):                                        # thwarts
    x, y, _ = hull(s, 0.78, 1.5 * PLANK)
    box(x - 0.14, x + 0.14, y, 0.16, 0.21, WOOD)

# The space inside, from the middle of the planks up to a lid over the rails: closed.
dry = shell(0.5 * PLANK, lambda p: WOOD, "dry", False)
faces["dry"].append([k for k in dry[0]])
for i in range(STATIONS):
    faces["dry"].append([dry[i][0], dry[i + 1][0], dry[i + 1][RIBS], dry[i][RIBS]])

print("# Written by boat.py.")
for p in points:
    print("v %.4f %.4f %.4f %.3g %.3g %.3g" % p)
for group, polygons in faces.items():
    print("o " + group)
    for polygon in polygons:
        print("f " + " ".join(map(str, polygon)))
