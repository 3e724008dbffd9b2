#!/usr/bin/env python3
"""Holds the source tree against layers.txt.

    check_layers.py ROOT LAYERS_FILE

Prints one line for each fault, FILE:LINE: MESSAGE, and exits 1 if there is any. What is a fault:
  * an include of a folder that the including folder may not include, or of a third-party header outside its folders;
  * an include that is not written from the root (relative, or beside the including file);
  * a folder with C++ or .proto files that layers.txt does not list, or lists twice;
  * a third-party header that layers.txt does not list;
  * a folder or header that is granted and that no include uses;
  * an include of another folder's private header (its first comment says "Private to this folder.");
  * a cycle among the folders, allowed or real;
  * a .cc file whose first include is not its own header (this proves that the header compiles alone).
"""
import fnmatch
import pathlib
import re
import sys

SOURCES = {".h", ".cc", ".proto"}
SKIPPED = {".git", "build", "node_modules"}
INCLUDE = re.compile(r'\s*#\s*include\s+([<"])([^>"]+)[>"]')
IMPORT = re.compile(r'\s*import\s+(?:public\s+)?"([^"]+)"')


class Layers:
    """The table: `folders` folder -> allowed folders, `headers` [(patterns, allowed folders)]."""

    def __init__(self, path):
        self.folders, self.headers, self.lines, self.faults = {}, [], {}, []
        section = None
        for number, line in enumerate(path.read_text().splitlines(), 1):
            line = line.split("#", 1)[0].strip()
            if line in ("[folders]", "[headers]"):
                section = line
            elif line:
                name, _, allowed = line.partition(":")
                if section == "[folders]":
                    if name.strip() in self.folders:
                        self.faults.append(f"{path.name}:{number}: {name.strip()} is listed a second time")
                    self.folders[name.strip()] = allowed.split()
                    self.lines[name.strip()] = number
                else:
                    self.headers.append((name.split(), allowed.split()))
                    self.lines[name.strip()] = number
        self._check_order(path.name)

    def _check_order(self, name):
        """Each folder names only folders above it, so the table cannot hold a cycle."""
        seen = set()
        for folder, allowed in self.folders.items():
            for other in allowed:
                if other != "*" and other not in seen:
                    self.faults.append(f"{name}:{self.lines[folder]}: {folder} names {other}, "
                                       "which is not above it: a cycle or an unknown folder")
            seen.add(folder)

    def folder_of(self, directory):
        """The listed folder that `directory` belongs to, or None."""
        for folder in self.folders:
            if folder == directory or covers(folder, directory):
                return folder
        return None

    def line_for_header(self, header):
        """(patterns, allowed folders) of the first line that matches, or None."""
        for patterns, allowed in self.headers:
            if any(fnmatch.fnmatchcase(header, p) for p in patterns):
                return patterns, allowed
        return None


def covers(pattern, directory):
    """Does a table entry (FOLDER, FOLDER/** or *) stand for `directory`?"""
    if pattern == "*" or pattern == directory:
        return True
    return pattern.endswith("/**") and (directory + "/").startswith(pattern[:-2])


def source_files(root):
    for path in sorted(root.rglob("*")):
        relative = path.relative_to(root)
        if path.suffix in SOURCES and not SKIPPED.intersection(relative.parts):
            yield relative


def includes_of(path):
    """(line number, is quoted, target) of each #include, or import in a .proto."""
    in_block_comment = False
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        if in_block_comment or line.lstrip().startswith("/*"):
            in_block_comment = "*/" not in line
            continue
        if path.suffix == ".proto":
            match = IMPORT.match(line)
            if match:
                yield number, True, "proto/" + match[1] if match[1].startswith("docent/") else match[1]
        else:
            match = INCLUDE.match(line)
            if match:
                yield number, match[1] == '"', match[2]


def is_private(path):
    """Does the comment that a header opens with say that it is private to its folder?"""
    opening = []
    for line in path.read_text(errors="replace").splitlines():
        if not line.startswith("//"):
            break
        opening.append(line[2:].strip())
    return "private to this folder" in " ".join(opening).lower()


def is_standard(header):
    return "/" not in header and "." not in header


class Checker:
    def __init__(self, root, layers):
        self.root, self.layers = root, layers
        self.faults = list(layers.faults)
        self.edges = {}  # folder -> {included folder: "file:line"}
        self.header_uses = set()  # (the line's first pattern, including folder)
        self.private = {}  # header -> is it private to its folder?

    def fault(self, place, message):
        self.faults.append(f"{place}: {message}")

    def run(self):
        for relative in source_files(self.root):
            directory = relative.parent.as_posix()
            folder = self.layers.folder_of(directory)
            if folder is None:
                self.fault(f"{relative}:1", f"folder {directory} is not listed in layers.txt")
                continue
            first = None
            for number, quoted, target in includes_of(self.root / relative):
                first = first or (number, target)
                self.check_include(f"{relative}:{number}", relative, folder, quoted, target)
            self.check_own_header_first(relative, first)
        self.check_cycles()
        self.check_grants()
        return self.faults

    def check_include(self, place, source, folder, quoted, target):
        if target.startswith((".", "/")):
            self.fault(place, f'"{target}" is not written from the root')
        elif "/" in target and self.layers.folder_of(str(pathlib.PurePosixPath(target).parent)) \
                and not target.endswith(".pb.h"):
            self.check_own(place, folder, target)
            self.check_private(place, source, target)
        elif quoted and (self.root / source.parent / target).exists():
            self.fault(place, f'"{target}" is not written from the root: {source.parent.as_posix()}/{target}')
        elif not is_standard(target) and source.suffix != ".proto":
            self.check_foreign(place, source.parent.as_posix(), target)

    def check_own(self, place, folder, target):
        other = self.layers.folder_of(str(pathlib.PurePosixPath(target).parent))
        if other == folder:
            return
        self.edges.setdefault(folder, {}).setdefault(other, place)
        allowed = self.layers.folders[folder]
        if "*" not in allowed and other not in allowed:
            self.fault(place, f"{folder} may not include {other}")

    def check_private(self, place, source, target):
        """A private header is for its own folder, and for the tests that mirror it."""
        header = self.root / target
        if target not in self.private:
            self.private[target] = header.exists() and is_private(header)
        if self.private[target] and source.parts[0] != "tests" and source.parent != pathlib.PurePosixPath(target).parent:
            self.fault(place, f"{target} is private to its folder")

    def check_foreign(self, place, directory, target):
        line = self.layers.line_for_header(target)
        if line is None:
            self.fault(place, f"header {target} is not listed in layers.txt")
            return
        patterns, allowed = line
        self.header_uses.add((patterns[0], directory))
        if not directory.startswith("tests/") and not any(covers(pattern, directory) for pattern in allowed):
            self.fault(place, f"{target} may not be included in {directory}, only in "
                              f"{', '.join(allowed) or 'no folder'}")

    def check_own_header_first(self, relative, first):
        own = relative.with_suffix(".h")
        if relative.suffix != ".cc" or not (self.root / own).exists():
            return
        if first is None or first[1] != own.as_posix():
            self.fault(f"{relative}:{first[0] if first else 1}", f'the first include is not "{own.as_posix()}"')

    def check_grants(self):
        """What is granted and not used says more than is true."""
        for folder, allowed in self.layers.folders.items():
            for other in allowed:
                if other != "*" and other not in self.edges.get(folder, {}):
                    self.fault(f"layers.txt:{self.layers.lines[folder]}", f"{folder} is granted {other} and does not include it")
        for patterns, allowed in self.layers.headers:
            for folder in allowed:
                if folder != "*" and (patterns[0], folder) not in self.header_uses:
                    self.fault(f"layers.txt:{self.layers.lines[' '.join(patterns)]}",
                               f"{folder} is granted {patterns[0]} and does not include it")

    def check_cycles(self):
        """Depth-first over the real edges; each cycle is reported once, at the include that closes it."""
        done, path = set(), []

        def visit(folder):
            path.append(folder)
            for other, place in sorted(self.edges.get(folder, {}).items()):
                if other in path:
                    self.fault(place, "cycle: " + " -> ".join(path[path.index(other):] + [other]))
                elif other not in done:
                    visit(other)
            done.add(path.pop())

        for folder in sorted(self.edges):
            if folder not in done:
                visit(folder)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: check_layers.py ROOT LAYERS_FILE")
    faults = Checker(pathlib.Path(sys.argv[1]), Layers(pathlib.Path(sys.argv[2]))).run()
    print("\n".join(faults), end="\n" if faults else "")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
