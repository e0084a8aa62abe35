#!/usr/bin/env python3
"""Writes the articulated figure of data/robot.toml, data/robot.obj: a robot of closed boxes and prisms that do not touch
each other, 1.75 m high, standing on z = 0 about the origin, walking. Usage: data/robot.py > data/robot.obj"""

import math


def turned(points, axis, degrees, about):
    """Turns points about an axis (x, y or z) through a point."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    out = []
    for p in points:
        q = [p[k] - about[k] for k in range(3)]
        q[i], q[j] = c * q[i] - s * q[j], s * q[i] + c * q[j]
        out.append([q[k] + about[k] for k in range(3)])
    return out


def prism(sides, radius, low, high, middle=(0, 0)):
    """An upright prism over a regular polygon: its points, and its faces as lists of their numbers."""
    ring = [(middle[0] + radius * math.cos(2 * math.pi * (k + 0.5) / sides),
             middle[1] + radius * math.sin(2 * math.pi * (k + 0.5) / sides)) for k in range(sides)]
    points = [[x, y, low] for x, y in ring] + [[x, y, high] for x, y in ring]
    faces = [list(reversed(range(sides))), list(range(sides, 2 * sides))]
    faces += [[k, (k + 1) % sides, sides + (k + 1) % sides, sides + k] for k in range(sides)]
    return points, faces


def box(low, high):
    (a, b, c), (d, e, f) = low, high
    points = [[a, b, c], [d, b, c], [d, e, c], [a, e, c], [a, b, f], [d, b, f], [d, e, f], [a, e, f]]
    return points, [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


parts = []


def add(part, material, turns=()):
    points, faces = part
    for axis, degrees, about in turns:
        points = turned(points, axis, degrees, about)
    parts.append((points, faces, material))


# The body, the head and its eyes, an antenna.
add(box((-0.2, -0.12, 0.9), (0.2, 0.12, 1.35)), "shell")
add(box((-0.17, -0.1, 0.78), (0.17, 0.1, 0.89)), "joint")
add(prism(12, 0.05, 1.355, 1.42), "joint")
add(box((-0.13, -0.12, 1.425), (0.13, 0.12, 1.65)), "shell", [("z", 15, (0, 0, 0))])
for side in (-1, 1):
    points, faces = prism(10, 0.035, 0, 0.02)
    points = turned(points, "x", 90, (0, 0, 0))
    points = [[x + 0.06 * side, y - 0.125, z + 1.55] for x, y, z in points]
    parts.append((turned(points, "z", 15, (0, 0, 0)), faces, "eye"))
add(prism(8, 0.01, 1.655, 1.75), "joint")
# Arms: shoulder, upper arm, elbow, fore-arm, hand with three fingers.
for side, swing in ((-1, 25), (1, -25)):
    shoulder = (0.27 * side, 0, 1.28)
    elbow = (0.27 * side, 0, 1.0)
    upper = [("x", swing, shoulder)]
    lower = [("x", -40, elbow)] + upper
    add(prism(12, 0.06, 1.23, 1.33, (0.27 * side, 0)), "joint", upper)
    add(box((0.27 * side - 0.04, -0.04, 1.03), (0.27 * side + 0.04, 0.04, 1.22)), "shell", upper)
    add(prism(12, 0.045, 0.965, 1.02, (0.27 * side, 0)), "joint", upper)
    add(box((0.27 * side - 0.035, -0.035, 0.76), (0.27 * side + 0.035, 0.035, 0.955)), "shell", lower)
    add(box((0.27 * side - 0.045, -0.03, 0.69), (0.27 * side + 0.045, 0.03, 0.75)), "joint", lower)
    for k in (-1, 0, 1):
        x = 0.27 * side + 0.03 * k
        add(box((x - 0.01, -0.01, 0.62), (x + 0.01, 0.01, 0.685)), "shell", lower)
# Legs: thigh, knee, shin, foot.
for side, swing in ((-1, -18), (1, 18)):
    hip = (0.1 * side, 0, 0.77)
    knee = (0.1 * side, 0, 0.42)
    upper = [("x", swing, hip)]
    lower = [("x", 20, knee)] + upper
    add(box((0.1 * side - 0.06, -0.06, 0.46), (0.1 * side + 0.06, 0.06, 0.76)), "shell", upper)
    add(prism(12, 0.055, 0.405, 0.45, (0.1 * side, 0)), "joint", upper)
    add(box((0.1 * side - 0.05, -0.05, 0.12), (0.1 * side + 0.05, 0.05, 0.395)), "shell", lower)
    add(box((0.1 * side - 0.06, -0.16, 0.05), (0.1 * side + 0.06, 0.08, 0.11)), "joint", lower)

lowest = min(p[2] for points, _, _ in parts for p in points)
print("# Written by data/robot.py.")
count = 0
for number, (points, faces, material) in enumerate(parts):
    print(f"usemtl {material}")
    for x, y, z in points:
        print(f"v {x!r} {y!r} {z - lowest + 0.01!r}")
    for face in faces:
        print("f " + " ".join(str(count + k + 1) for k in face))
    count += len(points)
