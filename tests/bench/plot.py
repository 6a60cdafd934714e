#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the benchmarks' tables: plot.py size|rate|speed|scale TABLE.csv
PICTURE.svg

size: bytes of complete files relative to Draco, a bar for each profile, its
parts on top of each other. rate: bytes against distance, a panel a model.
speed: figures as shares of what they must be. scale: time and memory by face
against faces.
"""
import csv
import math
import sys
from xml.sax.saxutils import escape

INK, SOFT, GRID = "#222", "#666", "#e4e4e4"


class Svg:
    def __init__(self, width, height, title, subtitle):
        self.size = width, height
        self.out = []
        self.text(24, 34, title, size=19, weight="bold")
        self.text(24, 55, subtitle, fill=SOFT, size=12.5)

    def text(self, x, y, what, anchor="start", fill=INK, size=11.5, turn=0,
             weight="normal"):
        turned = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
        self.out.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{fill}" '
            f'text-anchor="{anchor}" font-weight="{weight}"{turned} '
            f'stroke="white" stroke-width="3" paint-order="stroke">'
            f'{escape(what)}</text>')

    def line(self, points, stroke=GRID, width=1.0, dash=""):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.out.append(f'<polyline points="{path}" fill="none" '
                        f'stroke="{stroke}" stroke-width="{width}"{dashed}/>')

    def rect(self, x, y, w, h, fill):
        self.out.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{w:.1f}" '
                        f'height="{h:.1f}" fill="{fill}"/>')

    def dot(self, x, y, fill, radius=2.6):
        self.out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" '
                        f'fill="{fill}"/>')

    def legend(self, entries):
        """Lines of these (label, color) and what they mean, below the title."""
        x = 24
        for label, color in entries:
            self.line([(x, 82), (x + 24, 82)], color, 2.4)
            self.text(x + 31, 86, label)
            x += 60 + 6.3 * len(label)

    def save(self, path):
        w, h = self.size
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" '
                       f'height="{h}" viewBox="0 0 {w} {h}" '
                       'font-family="Helvetica, Arial, sans-serif">\n'
                       f'<rect width="{w}" height="{h}" fill="white"/>\n')
            file.write("\n".join(self.out) + "\n</svg>\n")


def unique(items):
    return list(dict.fromkeys(items))


# ---- size

PARTS = [("header", "#9aa0a6", "header, framing"), ("base", "#8e6bbf", "base"),
         ("connectivity", "#3d7cc9", "connectivity"),
         ("positions", "#efa23b", "positions")]


PART_NAMES = [name for name, _, _ in PARTS]


def sums(rows):
    """A model "sum" behind the models."""
    total = {}
    for row in rows:
        into = total.setdefault((row["bits"], row["coder"]), dict(
            row, model="sum", **{k: 0 for k in ("bytes", *PART_NAMES)}))
        for key in ("bytes", *PART_NAMES):
            into[key] += int(row[key] or 0)
    return rows + list(total.values())


def size_panel(svg, rows, top, height, bits):
    rows = sums([r for r in rows if r["bits"] == bits])
    models = unique(r["model"] for r in rows)
    kinds = unique(r["coder"] for r in rows if r["coder"] != "draco")
    draco = {r["model"]: int(r["bytes"]) for r in rows if r["coder"] == "draco"}
    ratio = [int(r["bytes"]) / draco[r["model"]] for r in rows]
    tick = 0.5 if max(ratio) > 2.2 else 0.2
    high = math.ceil(max(ratio) / tick + 0.3) * tick
    left, width, bottom = 70, svg.size[0] - 94, top + height
    scale = height / high
    for i in range(round(high / tick) + 1):
        y = bottom - i * tick * scale
        svg.line([(left, y), (left + width, y)])
        svg.text(left - 8, y + 4, f"{i * tick:.1f}", "end", SOFT)
    svg.text(22, top + height / 2, "bytes / Draco's bytes", "middle", SOFT,
             turn=-90)
    svg.text(left, top - 10, f"{bits}-bit positions", weight="bold", size=13)
    svg.line([(left, bottom - scale), (left + width, bottom - scale)],
             "#c0392b", 1.6, "6 4")
    step = width / len(models)
    bar = step * 0.8 / len(kinds)
    for m, model in enumerate(models):
        start = left + m * step + step * 0.1
        for k, kind in enumerate(kinds):
            row = next(r for r in rows
                       if r["model"] == model and r["coder"] == kind)
            y = bottom
            for part, color, _ in PARTS:
                tall = int(row[part]) / draco[model] * scale
                y -= tall
                svg.rect(start + k * bar, y, bar - 2, tall, color)
            middle = start + k * bar + bar / 2 - 1
            svg.text(middle, y - 4, f"{(bottom - y) / scale:.2f}", "middle",
                     size=8)
            svg.text(middle, bottom + 12, kind[0].upper(), "middle", SOFT, 9)
        svg.text(start + step * 0.4, bottom + 28, model, "middle",
                 weight="bold" if model == "sum" else "normal")
    svg.line([(left, bottom), (left + width, bottom)], INK)


def draw_size(rows, path):
    grids = unique(r["bits"] for r in rows)
    kinds = unique(r["coder"] for r in rows if r["coder"] != "draco")
    height = 260
    svg = Svg(1120, 150 + len(grids) * (height + 80),
              "Complete progressive files against single-rate Draco",
              "pmesh bytes / draco_encoder -cl 10 bytes, positions only; "
              + ", ".join(f"{k[0].upper()} {k}" for k in kinds)
              + "; dashed: Draco")
    x = 70
    for _, color, label in reversed(PARTS):
        svg.rect(x, 74, 12, 12, color)
        svg.text(x + 18, 84.5, label)
        x += 40 + 7 * len(label)
    for g, bits in enumerate(grids):
        size_panel(svg, rows, 136 + g * (height + 80), height, bits)
    svg.save(path)


# ---- rate

SERIES = {"balanced": ("#3d7cc9", "pmesh balanced"),
          "quality": ("#2a9d5c", "pmesh quality"),
          "optimal": ("#8e6bbf", "pmesh quality, optimal placement"),
          "draco": ("#d9622b", "best single Draco file")}


def envelope(points):
    """Those better than every smaller one."""
    best, kept = math.inf, []
    for x, y in sorted(points):
        if y < best:
            best = y
            kept.append((x, y))
    return kept


def stairs(points):
    """Between two sizes the earlier mesh is all there is."""
    path = points[:1]
    for (_, y), (x, lower) in zip(points, points[1:]):
        path += [(x, y), (x, lower)]
    return path


class Log:
    """A logarithmic axis over the values, from `start` to `end` pixels."""

    def __init__(self, values, start, end):
        self.low, self.high = min(values) / 1.15, max(values) * 1.15
        self.start, self.end = start, end

    def __call__(self, value):
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        for power in range(-12, 12):
            for digit in range(1, 10):
                value = digit * 10.0 ** power
                if self.low <= value <= self.high:
                    yield value, digit == 1


def short(value):
    for unit, name in ((1e6, " MB"), (1e3, " kB")):
        if value >= unit:
            return f"{value / unit:g}{name}"
    return f"{value:g} B" if value >= 1 else f"{value:.6f}".rstrip("0")


def rate_panel(svg, rows, model, box):
    left, top, width, height = box
    data = {}
    full = max(int(r["faces"]) for r in rows)
    for r in rows:
        data.setdefault(r["coder"], []).append(
            (int(r["bytes"]), 100 * float(r["rms"])))
    data["draco"] = envelope(data["draco"])
    every = [p for points in data.values() for p in points]
    x_of = Log([x for x, _ in every], left, left + width)
    y_of = Log([y for _, y in every], top + height, top)
    for value, strong in x_of.ticks():
        x = x_of(value)
        if strong:
            svg.line([(x, top), (x, top + height)])
            svg.text(x, top + height + 17, short(value), "middle", SOFT)
        svg.line([(x, top + height), (x, top + height + 4 + strong)], SOFT)
    for value, strong in y_of.ticks():
        y = y_of(value)
        if strong:
            svg.line([(left, y), (left + width, y)])
            svg.text(left - 8, y + 4, short(value).replace(" B", "") + " %",
                     "end", SOFT)
        svg.line([(left - 4 - strong, y), (left, y)], SOFT)
    svg.line([(left, top), (left, top + height), (left + width, top + height)],
             INK)
    svg.text(left + width, top + 16, model, "end", weight="bold", size=14)
    svg.text(left + width, top + 31, f"{full:,} faces", "end", SOFT)
    for coder in ("draco", *[c for c in SERIES if c != "draco"]):
        points = [(x_of(x), y_of(y)) for x, y in data.get(coder, [])]
        svg.line(stairs(points), SERIES[coder][0], 1.8)
        if coder == "draco":
            for x, y in points:
                svg.dot(x, y, SERIES[coder][0])


def draw_rate(rows, path):
    models = unique(r["model"] for r in rows)
    columns = min(3, len(models))
    wide, tall = 420, 330
    lines = -(-len(models) // columns)
    svg = Svg(max(columns * wide + 20, 860), 110 + lines * tall,
              "What a prefix of the file shows",
              "bytes received against RMS distance to the original, % of the "
              "bounding box's diagonal")
    svg.legend((label, color) for color, label in SERIES.values())
    for i, model in enumerate(models):
        box = (74 + i % columns * wide, 112 + i // columns * tall, wide - 84,
               tall - 50)
        rate_panel(svg, [r for r in rows if r["model"] == model], model, box)
    svg.save(path)


# ---- speed

def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def share(figure, bound):
    """Of a bound: 1 just meets it, less is better."""
    value = float(bound[1:])
    return figure / value if bound[0] == "<" else value / figure


def draw_speed(rows, path):
    bounded = [r for r in rows if r["must"] or r["aim"]]
    names = unique(r["what"] for r in bounded)
    models = unique(r["model"] for r in bounded)
    left, right, step = 470, 1000, 24
    svg = Svg(1240, 150 + step * len(names), "What is asked of speed and memory",
              "geometric means of " + ", ".join(models) + "; left of the line: "
              "met; bar: to what must be, circle: to what is aimed at")
    x_of = Log([1 / 12, 12], left, right)
    bottom = 110 + step * len(names)
    for value in (0.1, 0.2, 0.5, 1, 2, 5, 10):
        x = x_of(value)
        svg.line([(x, 90), (x, bottom)], "#c0392b" if value == 1 else GRID,
                 1.6 if value == 1 else 1, "6 4" if value == 1 else "")
        svg.text(x, bottom + 16, f"{value:g}", "middle", SOFT)
    svg.text((left + right) / 2, bottom + 34, "share of the bound (logarithmic)",
             "middle", SOFT)

    def place(value):
        return x_of(min(max(value, 1 / 12), 12))

    for i, name in enumerate(names):
        mine = [r for r in bounded if r["what"] == name]
        figure = geometric_mean([float(r["figure"]) for r in mine])
        y = 100 + step * i
        svg.text(left - 12, y + 11, name, "end")
        must, aim = mine[0]["must"], mine[0]["aim"]
        if must:
            x = place(share(figure, must))
            svg.rect(min(x, x_of(1)), y, abs(x - x_of(1)) + 1, 14,
                     "#d9622b" if share(figure, must) > 1 else "#2a9d5c")
        if aim:
            svg.dot(place(share(figure, aim)), y + 7, INK, 4)
        unit = "" if mine[0]["peer"] else " " + mine[0]["unit"]
        asked = (f"{must or aim}{'' if must else ' aim'}"
                 .replace("<", "\u2264 ").replace(">", "\u2265 "))
        svg.text(right + 12, y + 11, f"{figure:.3g}{unit}  ({asked})")
    svg.save(path)


# ---- scale

SCALED = {"contraction with log": "#3d7cc9", "whole bake": "#2a9d5c",
          "decode": "#8e6bbf", "meshopt_simplify": "#d9622b"}


def scale_panel(svg, rows, key, title, box):
    left, top, width, height = box
    points = {}
    for r in rows:
        if r[key]:
            points.setdefault(r["what"], []).append(
                (int(r["faces"]), float(r[key])))
    every = [p for line in points.values() for p in line]
    x_of = Log([x for x, _ in every], left, left + width)
    high = 1.15 * max(y for _, y in every)
    for value in (1e5, 1e6, 1e7):
        if x_of.low <= value <= x_of.high:
            svg.line([(x_of(value), top), (x_of(value), top + height)])
            svg.text(x_of(value), top + height + 17, f"{value:,.0f}", "middle",
                     SOFT)
    tick = 10 ** math.floor(math.log10(high / 2))
    tick *= 5 if high / tick > 12 else 2 if high / tick > 6 else 1
    for i in range(int(high / tick) + 1):
        y = top + height * (1 - i * tick / high)
        svg.line([(left, y), (left + width, y)])
        svg.text(left - 8, y + 4, f"{i * tick:g}", "end", SOFT)
    svg.text(left, top - 10, title, weight="bold", size=13)
    svg.text(left + width / 2, top + height + 36, "faces", "middle", SOFT)
    for what, line in points.items():
        drawn = [(x_of(x), top + height * (1 - y / high)) for x, y in line]
        svg.line(drawn, SCALED[what], 2)
        for x, y in drawn:
            svg.dot(x, y, SCALED[what])
        svg.text(drawn[-1][0] + 8, drawn[-1][1] + 4,
                 what if key == "us_per_face" else "", fill=SCALED[what])


def draw_scale(rows, path):
    svg = Svg(1120, 460, "Growth with the size of the mesh",
              "generated meshes, one core; memory is what the allocator hooks "
              "gave out at most, the input not counted")
    svg.legend(SCALED.items())
    scale_panel(svg, rows, "us_per_face", "CPU microseconds per face",
                (70, 130, 380, 270))
    scale_panel(svg, rows, "bytes_per_face", "peak memory, bytes per face",
                (640, 130, 380, 270))
    svg.save(path)


def main():
    kinds = {"size": draw_size, "rate": draw_rate, "speed": draw_speed,
             "scale": draw_scale}
    if len(sys.argv) != 4 or sys.argv[1] not in kinds:
        sys.exit(__doc__)
    with open(sys.argv[2], newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(sys.argv[2] + ": empty")
    kinds[sys.argv[1]](rows, sys.argv[3])


if __name__ == "__main__":
    main()
