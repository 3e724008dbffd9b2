"""Writes new output into the text of a tutorial. Standard library only."""
import re

from tutorial_blocks import compare, line_matches

VARIES = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(\.\d+)?(Z| UTC|[+-]\d\d:\d\d)?|\b\d\d:\d\d:\d\d(\.\d+)?\b|"
                    r"(?<=info snapshot at offset )\d+: .*|\b[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}\b|\b[0-9.]+ (ms|µs)\b")


def renewed_output(expected, output):
    """The output as a tutorial shows it: lines that are still right stay as they are written, others are written from
    `output` with `…` for times and random ids."""
    if compare(expected, output) is None:
        return expected
    lines = []
    for line in output:
        kept = next((e for e in expected if e != "…" and line_matches(e, line)), None)
        lines.append(kept if kept is not None else VARIES.sub("…", line))
    return lines


def renewed(text, outputs):
    """`outputs`: (step, lines) in the order of the text."""
    lines = text.split("\n")
    for step, output in reversed(outputs):
        begin = step.first_output - 1
        end = begin + len(step.expected)
        indent = len(lines[step.line - 1]) - len(lines[step.line - 1].lstrip()) if step.command else 0
        lines[begin:end] = [" " * indent + line for line in renewed_output(step.expected, output)]
    return "\n".join(lines)
