"""The fenced blocks of a tutorial: files to write, and commands with the output that they show. Standard library only.

A block with a `title` and another language than `console` is a file of that name:

    ```turtle title="hall.ttl"
    expo:Hall a docent:Hall .
    ```

A `console` block is a session: `$ ` begins a command, `> ` continues it, everything else is output. The `title` of a
console block names its terminal; blocks of one title go on in one shell. `^C` ends what runs there. A block that begins
with output goes on with the output of the command that still runs in that terminal. In the output, `…` stands for any
text within a line, and a line that is only `…` for any number of lines. All other blocks are for the reader alone.
"""
import dataclasses
import re

INTERRUPT = "^C"
FENCE = re.compile(r'^(?P<indent> *)```(?P<language>[\w+-]*)(?P<attributes>.*)$')
TITLE = re.compile(r'title="([^"]*)"')


@dataclasses.dataclass
class Step:
    """A file to write (`file`), or a command (`command`; None: what still runs) with the output to expect."""

    line: int                 # of the file or command in the tutorial, from 1
    terminal: str = ""
    command: str | None = None
    expected: list = dataclasses.field(default_factory=list)
    first_output: int = 0     # line of the first expected line, from 1
    file: str | None = None
    text: str = ""


def read_blocks(text):
    """The steps of a tutorial in order. ValueError: a fence that is not closed, with its line."""
    steps, lines, at = [], text.split("\n"), 0
    while at < len(lines):
        fence = FENCE.match(lines[at])
        at += 1
        if not fence:
            continue
        begin, indent = at, len(fence["indent"])
        while at < len(lines) and lines[at].strip() != "```":
            at += 1
        if at == len(lines):
            raise ValueError(f"{begin}: this block is not closed")
        body = [line[indent:] for line in lines[begin:at]]
        at += 1
        title = TITLE.search(fence["attributes"])
        if fence["language"] == "console":
            steps += read_session(body, begin + 1, title[1] if title else "")
        elif title:
            steps.append(Step(begin, file=title[1], text="\n".join(body) + "\n"))
    return steps


def read_session(body, first, terminal):
    """The steps of a console block whose first line is line `first` of the tutorial."""
    steps = []
    for number, line in enumerate(body, first):
        if line.startswith("$ ") or line == INTERRUPT:
            command = INTERRUPT if line == INTERRUPT else line[2:]
            steps.append(Step(number, terminal, command, [], number + 1))
        elif line.startswith("> ") and steps and steps[-1].command and not steps[-1].expected:
            steps[-1].command += "\n" + line[2:]
            steps[-1].first_output = number + 1
        else:
            if not steps:
                steps.append(Step(number, terminal, None, [], number))
            steps[-1].expected.append(line)
    return steps


def line_matches(pattern, line):
    return re.fullmatch(".*".join(re.escape(part) for part in pattern.split("…")), line) is not None


def compare(expected, actual):
    """None if `actual` is what `expected` says, else the indexes in both of the first lines that differ.

    An index may be the length of its list: there the other one has a line too many."""
    furthest = (0, 0)
    seen, waiting = set(), [(0, 0)]
    while waiting:
        e, a = waiting.pop()
        if (e, a) in seen:
            continue
        seen.add((e, a))
        furthest = max(furthest, (e, a))
        if e == len(expected) and a == len(actual):
            return None
        if e < len(expected) and expected[e] == "…":
            waiting.append((e + 1, a))
            if a < len(actual):
                waiting.append((e, a + 1))
        elif e < len(expected) and a < len(actual) and line_matches(expected[e], actual[a]):
            waiting.append((e + 1, a + 1))
    return furthest
