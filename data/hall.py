#!/usr/bin/env python3
"""Writes hall.toml: a living room of 445 patches in which a pouf moves."""

import pathlib

boxes = []


def box(name, low, high, material):
    boxes.append((name, low, high, material))


def at(x, y, parts, name, material):
    """Parts of a piece of furniture: (name, low, high) relative to (x, y, 0)."""
    for part, low, high in parts:
        shift = lambda v: [round(v[0] + x, 3), round(v[1] + y, 3), v[2]]
        box(f"{name}: {part}", shift(low), shift(high), material)


def table(x, y, length, width, height, name, material):
    leg = 0.06
    parts = [("top", [0, 0, height - 0.04], [length, width, height])]
    for k, (px, py) in enumerate([(0.04, 0.04), (length - 0.1, 0.04), (0.04, width - 0.1), (length - 0.1, width - 0.1)]):
        parts.append((f"leg {k + 1}", [px, py, 0], [px + leg, py + leg, height - 0.04]))
    at(x, y, parts, name, material)


def chair(x, y, back, name):
    """A chair of 0.42 x 0.42 whose back is at the low ("low") or high end of y."""
    parts = [("seat", [0, 0, 0.42], [0.42, 0.42, 0.46])]
    by = 0 if back == "low" else 0.38
    parts.append(("back", [0, by, 0.46], [0.42, by + 0.04, 0.9]))
    for k, (px, py) in enumerate([(0, 0), (0.38, 0), (0, 0.38), (0.38, 0.38)]):
        parts.append((f"leg {k + 1}", [px, py, 0], [px + 0.04, py + 0.04, 0.42]))
    at(x, y, parts, name, "oak")


def seat(x, y, width, cushions, name, material):
    """A sofa or armchair along x whose back is at low y."""
    arm = 0.16
    parts = [
        ("base", [arm, 0, 0.1], [width - arm, 0.8, 0.34]),
        ("back", [arm, 0, 0.34], [width - arm, 0.2, 0.8]),
        ("left arm", [0, 0, 0], [arm, 0.8, 0.58]),
        ("right arm", [width - arm, 0, 0], [width, 0.8, 0.58]),
    ]
    each = (width - 2 * arm) / max(cushions, 1)
    for k in range(cushions):
        parts.append((f"cushion {k + 1}", [round(arm + k * each + 0.01, 3), 0.2, 0.34],
                      [round(arm + (k + 1) * each - 0.01, 3), 0.78, 0.46]))
    at(x, y, parts, name, material)


seat(0.5, 0.1, 2.2, 3, "sofa", "green cloth")
seat(3.4, 0.15, 0.9, 0, "armchair 1", "red cloth")
seat(4.6, 0.15, 0.9, 0, "armchair 2", "red cloth")
table(1.0, 1.4, 1.1, 0.6, 0.42, "coffee table", "oak")
table(3.6, 3.2, 1.6, 0.9, 0.74, "dining table", "oak")
chair(3.85, 2.75, "low", "chair 1")
chair(4.55, 2.75, "low", "chair 2")
chair(3.85, 4.15, "high", "chair 3")
chair(4.55, 4.15, "high", "chair 4")
shelf = [("left side", [0, 0, 0], [0.03, 0.3, 2.0]), ("right side", [1.17, 0, 0], [1.2, 0.3, 2.0]),
         ("back", [0.03, 0.28, 0], [1.17, 0.3, 2.0])]
for k in range(5):
    z = round(0.1 + 0.45 * k, 3)
    shelf.append((f"shelf {k + 1}", [0.03, 0, z], [1.17, 0.28, round(z + 0.03, 3)]))
at(0.3, 4.7, shelf, "bookshelf", "dark wood")
box("books 1", [0.4, 4.75, 0.13], [0.8, 4.95, 0.38], "red cloth")
box("books 2", [0.7, 4.75, 0.58], [1.3, 4.95, 0.85], "blue cloth")
box("bench", [1.9, 4.55, 0], [3.3, 4.95, 0.45], "dark wood")
box("television foot", [2.45, 4.7, 0.45], [2.75, 4.8, 0.5], "black")
box("television", [2.1, 4.72, 0.5], [3.1, 4.78, 1.1], "black")
box("lamp foot", [0.15, 1.1, 0], [0.4, 1.35, 0.04], "black")
box("lamp pole", [0.26, 1.21, 0.04], [0.29, 1.24, 1.4], "black")
box("lamp shade", [0.12, 1.07, 1.4], [0.43, 1.38, 1.65], "shade")
box("rug", [0.7, 1.0, 0], [3.1, 2.6, 0.012], "blue cloth")
box("picture 2", [5.97, 1.4, 1.2], [6, 2.4, 1.9], "red cloth")
box("picture 1", [0, 2.2, 1.2], [0.03, 3.2, 1.9], "blue cloth")
box("cupboard", [5.45, 3.2, 0], [5.95, 4.6, 1.1], "dark wood")
box("pot", [5.5, 2.5, 0], [5.8, 2.8, 0.35], "red cloth")
box("plant", [5.55, 2.55, 0.35], [5.75, 2.75, 0.95], "green cloth")
box("pouf", [4.9, 1.5, 0], [5.2, 1.8, 0.3], "red cloth")
assert len(boxes) == 72, len(boxes)
HEAD = """# "Hall": a living room in which a pouf moves, after Feng, Chang, Shen and Yang, "Hierarchical link structure for dynamic
# scene radiosity", figure 10 and table 4: 445 patches, 8,149 sub-patches and 404,225 links there. Written by hall.py.
# [links] is chosen so that they are about as many here.

name = "Hall"
unit = "W/m^2"

[links]
eps2 = 8.25e-5
eps1 = 4.1e-5
smallest_area = 0.015

[camera]
eye = [0.9, 4.3, 1.85]
target = [4.3, 1.5, 0.5]
vertical_fov = 70
"""
MATERIALS = {
    "wall": "[0.72, 0.7, 0.64]", "floor": "[0.42, 0.32, 0.22]", "oak": "[0.55, 0.42, 0.26]",
    "dark wood": "[0.3, 0.2, 0.13]", "green cloth": "[0.25, 0.4, 0.22]", "red cloth": "[0.55, 0.15, 0.12]",
    "blue cloth": "[0.18, 0.25, 0.45]", "black": "0.06", "shade": "[0.7, 0.65, 0.5]",
}
ROOM = """
[[material]]
name = "light"
rho = 0.5
E = [60, 56, 50]

[[object]]
name = "room"
material = "wall"
polygons = [
  {polygon = [[0, 0, 0], [6, 0, 0], [6, 5, 0], [0, 5, 0]], material = "floor"},
  {polygon = [[0, 0, 0], [0, 0, 2.6], [6, 0, 2.6], [6, 0, 0]]},
  {polygon = [[6, 0, 0], [6, 0, 2.6], [6, 5, 2.6], [6, 5, 0]]},
  {polygon = [[6, 5, 0], [6, 5, 2.6], [0, 5, 2.6], [0, 5, 0]]},
  {polygon = [[0, 5, 0], [0, 5, 2.6], [0, 0, 2.6], [0, 0, 0]]},
  {polygon = [[0, 0, 2.6], [0, 2.2, 2.6], [3, 2.2, 2.6], [3, 0, 2.6]]},  # ceiling, with two lights in it
  {polygon = [[3, 0, 2.6], [3, 2.2, 2.6], [6, 2.2, 2.6], [6, 0, 2.6]]},
  {polygon = [[0, 2.2, 2.6], [0, 2.8, 2.6], [1.2, 2.8, 2.6], [1.2, 2.2, 2.6]]},
  {polygon = [[1.2, 2.2, 2.6], [1.2, 2.8, 2.6], [2.2, 2.8, 2.6], [2.2, 2.2, 2.6]], material = "light"},
  {polygon = [[2.2, 2.2, 2.6], [2.2, 2.8, 2.6], [3.8, 2.8, 2.6], [3.8, 2.2, 2.6]]},
  {polygon = [[3.8, 2.2, 2.6], [3.8, 2.8, 2.6], [4.8, 2.8, 2.6], [4.8, 2.2, 2.6]], material = "light"},
  {polygon = [[4.8, 2.2, 2.6], [4.8, 2.8, 2.6], [6, 2.8, 2.6], [6, 2.2, 2.6]]},
  {polygon = [[0, 2.8, 2.6], [0, 5, 2.6], [6, 5, 2.6], [6, 2.8, 2.6]]},
]
"""
EVENTS = """
[[event]]
time = 1
object = "pouf"
operation = "move"
translate = [0.15, -0.1, 0]

[[event]]
time = 2
object = "pouf"
operation = "move"
rotate = {axis = [0, 0, 1], degrees = 30}
pivot = [5.05, 1.65, 0]
translate = [0.35, -0.3, 0]

[[event]]
time = 3
object = "pouf"
operation = "move"
rotate = {axis = [0, 0, 1], degrees = 45}
pivot = [5.05, 1.65, 0]
translate = [0.6, -0.5, 0]
"""

with open(pathlib.Path(__file__).with_name("hall.toml"), "w") as out:
    out.write(HEAD)
    for name, rho in MATERIALS.items():
        out.write(f'\n[[material]]\nname = "{name}"\nrho = {rho}\n')
    out.write(ROOM)
    for name, low, high, material in boxes:
        out.write(f'\n[[object]]\nname = "{name}"\nbox = {{min = {low}, max = {high}}}\nmaterial = "{material}"\n')
    out.write(EVENTS)
