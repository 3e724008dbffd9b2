#!/usr/bin/env python3
"""Makes a man page of what a program says with --help.

    man_page.py PROGRAM OUTPUT.1

The help of the program and of all its commands, as graph/command_line/help_layout.cc lays it out: a description, the
usage, sections of items ("  NAME   what it is"), and a footer with exit codes and examples. Standard library only.
"""
import os
import pathlib
import re
import subprocess
import sys

EXIT_STATUS = """0 is success, 1 a negative answer as each command says, 2 bad usage or input, no server, or output that could not
be written."""
ENVIRONMENT = {
    "docent": [("DOCENT_SERVER", "Address of the server, where --server is not given."),
               ("DOCENT_GRPC, DOCENT_HTTP", "Addresses that docent serve listens at, where --grpc and --http are not given."),
               ("DOCENT_DATA_DIR", "Folder with the ontologies that docent check reads, in the place of /usr/share/docent."),
               ("NO_COLOR", "If it is not empty, no colours are used."),
               ("COLUMNS", "Width of the help, where standard output is no terminal."),
               ("XDG_STATE_HOME", "The data folder is docent in this folder, by default ~/.local/state.")],
    "docent-robot": [("DOCENT_SERVER", "Address of the server, where --server is not given."),
                     ("DOCENT_DATA_DIR", "Folder with the scenarios, in the place of /usr/share/docent."),
                     ("XDG_STATE_HOME", "The folder of --out lies in this folder's docent, by default ~/.local/state.")],
}
FILES = {
    "docent": [("/etc/docent/docent.toml", "Settings of the system service docent.service."),
               ("/var/lib/docent", "Its data folder."),
               ("/usr/share/docent", "Ontologies and scenarios.")],
    "docent-robot": [("/usr/share/docent/scenarios", "Scenarios; the hall of the first one is the default.")],
}
SEE_ALSO = {"docent": "docent-robot(1), systemctl(1)", "docent-robot": "docent(1)"}


class Help:
    """The parts of a help text: description, usage, sections [(title, [(name, text)])], footer [line]."""

    def __init__(self, text):
        lines = text.rstrip("\n").split("\n")
        usage = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
        self.description = " ".join(line for line in lines[:usage] if line)
        self.usage = lines[usage].removeprefix("Usage: ")
        self.sections, self.footer = [], []
        for line in lines[usage + 1:]:
            if self.footer and line[:1].islower():  # goes on with the line before
                self.footer[-1] += f" {line}"
            elif self.footer or re.match(r"(Exit code|Examples?:|SIG)", line):
                self.footer.append(line)
            elif line and not line.startswith(" ") and line.endswith(":"):
                self.sections.append((line.rstrip(":"), []))
            elif line and not line.startswith(" "):
                self.footer.append(line)
            elif line.strip():
                self.item(line)

    def item(self, line):
        items = self.sections[-1][1]
        if line.startswith("   ") and items and not items[-1][1]:  # its name took the whole line before
            items[-1] = (items[-1][0], line.strip())
            return
        name, _, text = line.strip().partition("  ")
        items.append((name, text.strip()))

    def commands(self):
        """Names of the commands: what is listed and is neither an option nor a positional."""
        return [name for title, items in self.sections if title not in ("Options", "Positionals") for name, _ in items
                if re.fullmatch(r"[a-z]+", name)]


def help_of(command):
    done = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True,
                          env={**os.environ, "COLUMNS": "10000", "HOME": "~", "XDG_STATE_HOME": "", "LC_ALL": "C.UTF-8"})
    return Help(done.stdout)


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def paragraphs(items):
    return [line for name, text in items for line in (".TP", ".B " + roff(name), roff(text) or "\\&")]


def options(help_text):
    return [item for title, items in help_text.sections if title in ("Options", "Positionals") for item in items
            if not item[0].startswith("-h, --help")]


def footer(lines):
    """Sentences as they are; examples as they are typed."""
    out, literal = [], False
    for line in lines:
        if line.startswith("  ") != literal:
            literal = not literal
            out += [".RS 4", ".nf"] if literal else [".fi", ".RE"]
        out += [roff(line.strip())] if literal else [".PP", roff(line)]
    return out + ([".fi", ".RE"] if literal else [])


def command_sections(program, words):
    command = [program, *words]
    text = help_of(command)
    name = " ".join([pathlib.Path(program).name, *words])
    # the usage begins with the name alone where the program does not know how it was called
    out = [f'.SS "{roff(name)}{roff(text.usage.partition(" [OPTIONS]")[2])}"', roff(text.description)]
    out += paragraphs(options(text)) + footer(text.footer)
    for below in text.commands():
        out += command_sections(program, [*words, below])
    return out


def page(program):
    name = pathlib.Path(program).name
    text = help_of([program])
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    summary = text.description.removeprefix("Docent: ").split(",")[0].split(":")[0].rstrip(".")
    out = [f'.TH {name.upper()} 1 "" "Docent {version}" "User Commands"',
           ".SH NAME", f"{roff(name)} \\- {roff(summary[:1].lower() + summary[1:])}",
           ".SH SYNOPSIS", ".B " + roff(text.usage),
           ".SH DESCRIPTION", roff(text.description),
           ".SH OPTIONS", *paragraphs(options(text)), *footer(text.footer)]
    if text.commands():
        out.append(".SH COMMANDS")
        for command in text.commands():
            out += command_sections(program, [command])
    out += [".SH EXIT STATUS", EXIT_STATUS]
    out += [".SH ENVIRONMENT", *paragraphs(ENVIRONMENT.get(name, []))]
    out += [".SH FILES", *paragraphs(FILES.get(name, []))]
    out += [".SH SEE ALSO", roff(SEE_ALSO.get(name, ""))]
    return "\n".join(out) + "\n"


def main():
    pathlib.Path(sys.argv[2]).write_text(page(sys.argv[1]), encoding="utf-8")


if __name__ == "__main__":
    main()
