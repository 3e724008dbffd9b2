#!/usr/bin/env python3
"""Holds the browser app against web_order.txt.

    check_web_order.py WEB_SOURCE ORDER_FILE

ORDER_FILE has one floor a line, the lowest first; folders in one line stand beside each other and do not know each other. Prints one
line for each fault, FILE:LINE: MESSAGE, and exits 1 if there is any. What is a fault:
  * an import of a folder on the same floor or on a higher one (files beside the folders belong to the highest floor);
  * a folder with source files that is not listed, or a listed one without;
  * an import of a file that does not exist (generated messages excepted);
  * files that import each other in a circle; an import of types alone is none, as it is gone at run time.
"""
import pathlib
import re
import sys

SOURCES = (".ts", ".tsx", ".css")
IMPORT = re.compile(r'(?:^|\n)\s*(?:import|export)\s+(type\s+)?[^;"]*?"(\.[^"]+)"|import\(\s*"(\.[^"]+)"\s*\)|@import\s+"(\.[^"]+)"')
GENERATED = "gen"


def read_order(path):
    """Folder -> number of its floor, from 0."""
    floors = [line.split("#", 1)[0].replace(",", " ").split() for line in path.read_text().splitlines()]
    return {folder: number for number, floor in enumerate(filter(None, floors)) for folder in floor}


def imports_of(path):
    """[(line, imported path, of types alone)]"""
    text = path.read_text(encoding="utf-8")
    for match in IMPORT.finditer(text):
        name = match[2] or match[3] or match[4]
        yield text.count("\n", 0, match.end()) + 1, path.parent / name, bool(match[1])


def file_of(name):
    """The file that an import names, or None."""
    for suffix in ("", ".ts", ".tsx"):
        file = name.with_name(name.name + suffix)
        if file.is_file():
            return file.resolve()
    return None


def circle_through(file, imports):
    """The shortest way along imports from `file` back to it, or None."""
    ways, seen = [[file]], set()
    while ways:
        longer = []
        for way in ways:
            for after in imports.get(way[-1], ()):
                if after == file:
                    return way + [file]
                if after not in seen:
                    seen.add(after)
                    longer.append(way + [after])
        ways = longer
    return None


def check(source, order_file):
    source = source.resolve()
    order = read_order(order_file)
    top = max(order.values(), default=0)
    faults, imports, found = [], {}, {GENERATED}

    def folder_of(file):
        parts = file.relative_to(source).parts
        return parts[0] if len(parts) > 1 else ""

    for file in sorted(f for f in source.rglob("*") if f.suffix in SOURCES):
        folder, shown = folder_of(file), file.relative_to(source)
        if folder == GENERATED:
            continue
        found.add(folder)
        if folder and folder not in order:
            faults.append(f"{shown}:1: the folder {folder} is not in {order_file.name}")
            continue
        for line, name, types_alone in imports_of(file):
            target = file_of(name)
            if target is None:
                if GENERATED not in name.parts:
                    faults.append(f"{shown}:{line}: there is no {name.name}")
                continue
            if source not in target.parents:
                continue  # the package of the client
            other = folder_of(target)
            if not types_alone:
                imports.setdefault(file, []).append(target)
            if other != folder and order.get(other, top + 1) >= order.get(folder, top + 1):
                faults.append(f"{shown}:{line}: {folder or 'this file'} may not import {other or target.name}, "
                              "which is not below it")
    for folder in sorted(set(order) - found):
        faults.append(f"{order_file.name}:1: {folder} has no source files")
    told = set()
    for file in imports:
        circle = circle_through(file, imports)
        if circle and not told & set(circle):
            told |= set(circle)
            faults.append(f"{file.relative_to(source)}:1: a circle of imports: " + " → ".join(f.name for f in circle))
    return faults


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    FAULTS = check(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    print("\n".join(FAULTS) if FAULTS else "the order of the app's folders holds")
    sys.exit(1 if FAULTS else 0)
