#!/usr/bin/env python3
"""Checks built web pages: every link within them leads somewhere, and no page asks another host for anything.

    check_site.py FOLDER

Prints PAGE: MESSAGE for each fault and exits 1 if there is any. Standard library only.
"""
import html.parser
import pathlib
import re
import sys
import urllib.parse

LOADING = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src"), ("audio", "src"),
           ("link", "href"), ("object", "data"), ("form", "action")}
REMOTE = re.compile(r"^(https?:)?//", re.I)
REMOTE_IN_CSS = re.compile(r"(?:url\(|@import)\s*['\"]?((?:https?:)?//[^'\")\s]+)", re.I)


class Page(html.parser.HTMLParser):
    """The anchors of one page, what it links to and what it loads."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.links, self.loaded = {"", "top"}, [], []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if attributes.get("id"):
            self.anchors.add(attributes["id"])
        if tag == "a" and attributes.get("name"):
            self.anchors.add(attributes["name"])
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])
        if "mermaid" in (attributes.get("class") or "").split():
            self.loaded.append("https://unpkg.com/mermaid")  # the theme's script fetches it for such a block
        for (loading, attribute) in LOADING:
            # `rel` says what a link is for: canonical and the like load nothing
            if tag == loading and attributes.get(attribute) and attributes.get("rel") not in ("canonical", "prev", "next"):
                self.loaded.append(attributes[attribute])


def faults_of(folder):
    pages = {path.resolve(): Page(path) for path in sorted(folder.rglob("*.html"))}
    faults = []
    for path, page in pages.items():
        name = path.relative_to(folder.resolve())
        faults += [f"{name}: loads {address} from another host" for address in page.loaded if REMOTE.match(address)]
        if path.name == "404.html":  # its links begin at the root of a web server
            continue
        for link in page.links + page.loaded:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            if not target.exists():
                faults.append(f"{name}: {link} leads to no file")
            elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{name}: {link} leads to no such heading")
    for path in sorted(folder.rglob("*.css")):
        faults += [f"{path.relative_to(folder)}: loads {address} from another host" for address in
                   REMOTE_IN_CSS.findall(path.read_text())]
    return faults, len(pages)


def main():
    if {"-h", "--help"} & set(sys.argv[1:]) or len(sys.argv) != 2:
        print(__doc__)
        sys.exit(0 if len(sys.argv) == 2 else 2)
    faults, pages = faults_of(pathlib.Path(sys.argv[1]))
    print("\n".join(faults) if faults else f"{pages} pages, all links lead somewhere")
    sys.exit(1 if faults or not pages else 0)


if __name__ == "__main__":
    main()
