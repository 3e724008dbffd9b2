"""Puts the pages of whole folders into the navigation of mkdocs.yml. A hook of mkdocs; see its `hooks` there."""
import pathlib


def on_config(config):
    root = pathlib.Path(config["docs_dir"])
    config["nav"] = expanded(config["nav"], root, named_pages(config["nav"]))
    return config


def named_pages(entries):
    """The pages that the navigation names one by one."""
    pages = set()
    for entry in entries:
        for value in entry.values() if isinstance(entry, dict) else [entry]:
            pages |= named_pages(value) if isinstance(value, list) else {value}
    return pages


def expanded(entries, root, named):
    """The same navigation with `folder/` replaced by its pages. A section without pages is left out."""
    result = []
    for entry in entries:
        if isinstance(entry, dict):
            for title, value in entry.items():
                value = expanded(value, root, named) if isinstance(value, list) else value
                if value:
                    result.append({title: value})
        elif entry.endswith("/"):
            pages = sorted(f"{entry}{path.name}" for path in (root / entry).glob("*.md"))
            result += [page for page in pages if page not in named]
        else:
            result.append(entry)
    return result
