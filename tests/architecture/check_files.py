#!/usr/bin/env python3
"""Checks of files as such: size, names, and marks of unfinished work.

    check_files.py ROOT

  * a C++ or Python file over 600 lines stands with its reason in ARCHITECTURE.md;
  * C++ files are named in snake_case; folders lie at most two levels below the top (tests mirror the tree below tests/);
  * no marks of unfinished work, no disabled or skipped test (but the W3C suites in tests/conformance, which are not part
    of the tree, may be absent).
Prints FILE:LINE: MESSAGE for each fault and exits 1 if there is any.
"""
import pathlib
import re
import subprocess
import sys

MAX_LINES = 600
CODE = {".h", ".cc", ".py", ".proto"}
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME)\b|\bDISABLED_[A-Z]\w*|GTEST_" r"SKIP")


def tracked(root):
    """Files that git knows, or all of them outside a checkout (an unpacked archive)."""
    git = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True)
    if git.returncode == 0 and git.stdout:
        return [p for p in map(pathlib.Path, git.stdout.splitlines()) if (root / p).is_file()]
    return [p.relative_to(root) for p in root.rglob("*") if p.is_file() and "build" not in p.relative_to(root).parts]


def main():
    root = pathlib.Path(sys.argv[1])
    reasons = (root / "ARCHITECTURE.md").read_text() if (root / "ARCHITECTURE.md").exists() else ""
    faults = []
    for path in tracked(root):
        if path.suffix not in CODE:
            continue
        lines = (root / path).read_text(errors="replace").splitlines()
        if len(lines) > MAX_LINES and path.as_posix() not in reasons:
            faults.append(f"{path}:{MAX_LINES + 1}: {len(lines)} lines without a reason in ARCHITECTURE.md")
        if not re.fullmatch(r"[a-z0-9_]+", path.stem):
            faults.append(f"{path}:1: the file name is not snake_case")
        if len(path.parts) - 1 > 3 + (path.parts[0] in ("tests", "proto")):
            faults.append(f"{path}:1: more than two folder levels below the top")
        for number, line in enumerate(lines, 1):
            if UNFINISHED.search(line) and path.parts[:2] != ("tests", "conformance"):
                faults.append(f"{path}:{number}: unfinished work or a disabled test: {line.strip()}")
    print("\n".join(faults), end="\n" if faults else "")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
