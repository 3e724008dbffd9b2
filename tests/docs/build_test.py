#!/usr/bin/env python3
"""The documentation builds without a warning, its links lead somewhere, and its pages load nothing from other hosts."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    if not os.path.isdir("/usr/share/mkdocs/themes/material") or not shutil.which("mkdocs"):
        print("mkdocs or its theme material is not installed; `scripts/setup docs` installs them")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="docs-build-") as folder:
        sys.exit(subprocess.run([ROOT / "scripts/docs"], env={**os.environ, "DOCENT_DOCS_FOLDER": folder}).returncode)


if __name__ == "__main__":
    main()
