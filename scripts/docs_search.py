"""Writes the index of the search also as a script, which pages that are read from a disk may load. A hook of mkdocs; see its
`hooks` there."""
import pathlib


def on_post_build(config):
    folder = pathlib.Path(config["site_dir"]) / "search"
    index = (folder / "search_index.json").read_text()
    (folder / "search_index.js").write_text(f"window.__search = {{ index: Promise.resolve({index}) }};\n")
