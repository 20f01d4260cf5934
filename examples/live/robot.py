"""A robot that explores a building, of which it sees a few metres around it at a time.

The building comes from a ROS map, which GraphDRL never sees. It is told what the robot's sensor sees, as updates of an
occupancy grid, and says which way to go, from cell to cell. The robot looks around after each metre.

    python robot.py ../2-ros/floor.yaml
    python robot.py ../2-ros/floor.yaml --budget 60 --end start --out floor.html

Other options go to `graphdrl explore --live`. Ends with status 1 where it did not see all that it can reach.
"""

import argparse
import math
import pathlib
import subprocess
import sys
import tempfile

from client import PROGRAM, Guide

SIDE, RADIUS, SIGHT, LOOKS_AFTER = 0.1, 0.2, 3.0, 1.0  # metres: of a cell, the robot, what it sees, and how often


def read_building(file):
    """Rows of characters from the bottom, with a wall around; '.' is where the robot touches nothing."""
    sizes = ["--cell-size", str(SIDE), "--robot-radius", str(RADIUS)]
    with tempfile.TemporaryDirectory() as folder:
        text = pathlib.Path(folder) / "building.txt"
        try:
            command = [PROGRAM, "maps", "convert", file, "--out", text, *sizes]
            subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
        except OSError as error:
            sys.exit(f"{PROGRAM}: {error.strerror}")
        except subprocess.CalledProcessError as error:  # it has said why
            sys.exit(error.returncode)
        rows = [f"#{line}#" for line in text.read_text().splitlines()[::-1]]
    return ["#" * len(rows[0]), *rows, "#" * len(rows[0])]


def look(building, row, col):
    """The cells around, of which those are known that a line leads to without an obstacle between."""
    reach = int(SIGHT / SIDE)
    side = 2 * reach + 1
    seen = [-1] * (side * side)
    for ray in range(720):
        for step in range(reach + 1):
            up, right = (round(step * f(ray * math.pi / 360)) for f in (math.sin, math.cos))
            blocked = building[row + up][col + right] != "."
            seen[(up + reach) * side + right + reach] = 100 if blocked else 0
            if blocked:
                break
    corner = [(col - reach) * SIDE, (row - reach) * SIDE]
    return {"origin": corner, "resolution": SIDE, "width": side, "height": side, "data": seen}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", metavar="MAP.yaml")
    arguments, options = parser.parse_known_args()
    building = read_building(arguments.map)
    free = [(row, col) for row, line in enumerate(building) for col, cell in enumerate(line) if cell == "."]

    guide = Guide(*options)
    row, col = free[0]
    while True:
        at = [(col + 0.5) * SIDE, (row + 0.5) * SIDE]
        answer = guide.answer({"at": at, "cells": look(building, row, col)})
        if "done" in answer:
            break
        for x, y in answer["goto"][: int(LOOKS_AFTER / SIDE)]:
            row, col = int(y / SIDE), int(x / SIDE)

    done, report = answer["done"], answer["report"]
    print(f"{done} after {report['cost']:.1f} m: {report['seen']} of {len(free)} free cells seen")
    return int(done != "covered")


if __name__ == "__main__":
    sys.exit(main())
