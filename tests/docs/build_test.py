#!/usr/bin/env python3
"""The documentation builds without a warning, its links lead somewhere, and its pages load nothing from other hosts."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def sessions_that_are_copied_whole(site):
    """Boxes of commands with their output have no button that copies both: style.css hides it by their class."""
    if ".language-console .md-clipboard { display: none; }" not in (site / "style.css").read_text():
        return ["style.css does not hide the copy button of sessions"]
    prompts = [page for page in site.rglob("*.html")
               if any('class="gp"' in box and "language-console" not in box.split(">")[0]
                      for box in page.read_text().split('<div class="')[1:])]
    return [f"{page.relative_to(site)}: a session has no class language-console" for page in prompts]


def search_from_disk(site):
    """A browser finds something in the pages of the folder, without a web server."""
    if not shutil.which("chromium"):
        print("chromium is not installed: search in pages on a disk is not tried; `scripts/setup web` installs it")
        return []
    with tempfile.TemporaryDirectory(prefix="docs-browser-") as profile:
        page = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                               "--virtual-time-budget=60000", "--dump-dom", f"file://{site}/reference/cli.html?q=turns"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=200).stdout
    return [] if re.search(r"[1-9][0-9]* matching documents", page) else ["a search in pages on a disk finds nothing"]


def main():
    if not os.path.isdir("/usr/share/mkdocs/themes/material") or not shutil.which("mkdocs"):
        print("mkdocs or its theme material is not installed; `scripts/setup docs` installs them")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="docs-build-") as folder:
        if subprocess.run([ROOT / "scripts/docs"], env={**os.environ, "DOCENT_DOCS_FOLDER": folder}).returncode != 0:
            sys.exit(1)
        faults = sessions_that_are_copied_whole(pathlib.Path(folder)) + search_from_disk(pathlib.Path(folder))
        print("\n".join(faults))
        sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
