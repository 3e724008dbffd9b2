"""The pages of docs/reference that are made from the program: one function a page, which gives its Markdown.

Standard library only. What they read: the help texts, a running server's /metrics, the limits in graph/base, the kinds of
findings (`docent reference`), and the ontologies as the server holds them.
"""
import json
import os
import re
import subprocess
import sys

from docent_stage import ROOT

sys.path.insert(0, str(ROOT / "packaging"))
from man_page import Help  # noqa: E402

SHARE = "/usr/share/docent"
NOTE = "\n<!-- Made by scripts/reference from the program. Edit the program's own texts, then run scripts/reference. -->\n"
MEMORY_UNITS = ((30, "GiB"), (20, "MiB"), (10, "KiB"))
TIME_UNITS = ((3600000, "h"), (60000, "min"), (1000, "s"))


def cell(text):
    """A text within a table."""
    return re.sub(r"\s+", " ", text).strip().replace("|", "\\|").replace("<", "&lt;")


def table(head, rows):
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join(lines) + "\n"


def sentence(text):
    """With a full stop, and with a capital letter unless it begins with a name: of a value, a program, a property."""
    text = text.strip()
    if not text:
        return text
    if re.match(r"[a-z]+( |$|[,;] )", text):
        text = text[0].upper() + text[1:]
    return text if text.endswith((".", "?", "!", "…")) else text + "."


# ---- command line --------------------------------------------------------------------------------------------------------


def help_of(program, arguments):
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("DOCENT_", "XDG_"))}
    environment.update(HOME="~", NO_COLOR="1", COLUMNS="100000", TERM="dumb")
    done = subprocess.run([program, *arguments, "--help"], env=environment, capture_output=True, text=True, timeout=60, check=True)
    return done.stdout.replace(str(ROOT), SHARE)


def option_row(name, told):
    """`--data FOLDER` and `Data folder (default: /x) (environment: Y)`: its name, what it takes, and what it is for."""
    flags, _, kind = name.partition(" ") if not name.startswith("-") or ", " not in name else name.rpartition(", ")[2].partition(" ")
    if ", " in name:
        flags = name.removesuffix(f" {kind}").strip()
    if kind.startswith("{"):
        kind = ", ".join(f"`{value}`" for value in kind.strip("{}").split(","))
    kind = "" if kind == "..." else kind
    notes = []
    for word, note in (("environment", "Or the environment variable `{}`."), ("default", "Default: `{}`.")):
        given = re.search(rf" \({word}: ([^)]*)\)$", told)
        if given:
            told = told[:given.start()]
            notes.insert(0, note.format(given[1]))
    if told.endswith("; may be repeated"):
        told = told.removesuffix("; may be repeated")
        notes.append("May be repeated.")
    return [f"`{flags.replace(', ', '`, `')}`", kind, " ".join([sentence(cell(told)), *notes])]


def rows_of(told, title):
    """Of the section of that title, without --help and --version."""
    return [option_row(*pair) for name, pairs in told.sections if name == title for pair in pairs
            if not (pair[0].startswith("-h,") or pair[0].split(",")[-1].strip() == "--version")]


def footer_of(told):
    """Exit codes as sentences, examples as they are typed."""
    sentences = [line for line in told.footer if not line.startswith("  ") and not line.startswith("Example")]
    examples = [line.strip() for line in told.footer if line.startswith("  ")]
    parts = [" ".join(map(sentence, sentences)) + "\n"] if sentences else []
    return parts + (["```text\n" + "\n".join(f"$ {line}" for line in examples) + "\n```\n"] if examples else [])


def command_section(program, path, level, common):
    name = " ".join([program.name, *path])
    told = Help(help_of(program, path))
    parts = [f"{'#' * level} {name}\n"]
    if path:
        parts.append(sentence(cell(told.description)) + "\n")
        parts.append(f"```text\n{told.usage}\n```\n")
    if any(row[0] == "`--server`" for row in rows_of(told, "Options")) and common:
        parts.append("Speaks to a running server: takes the [common options](#common-options), too.\n")
    for title, head in (("Positionals", "argument"), ("Options", "option")):
        rows = [row for row in rows_of(told, title) if row not in common]
        if rows:
            parts.append(table([head, "takes", "meaning"], rows))
    parts += footer_of(told)
    for sub in told.commands():
        parts.append(command_section(program, [*path, sub], min(level + 1, 3), common))
    return "\n".join(parts)


def operations_section(program):
    """What `docent-robot --operations` says, as a table."""
    text = subprocess.run([program, "--operations"], capture_output=True, text=True, timeout=60, check=True).stdout
    head, *rows = [re.split(r"  +", line.strip()) for line in text.splitlines()]
    code = lambda column, word: "" if word == "-" else f"`{word}`" if head[column] in ("operation", "inputs", "outputs", "capability") else cell(word)
    return ("### What the simulated robot can do\n\n`docent-robot --operations` prints this table. Operations that occupy different parts of the "
            "robot may run beside each other. A type is that of the part.\n\n"
            + table(head, [[code(i, word) for i, word in enumerate(row)] for row in rows]))


def cli_page(programs):
    intro = """
Every command tells its options with `--help`. The exit code is 0 when all went well, 1 when the answer is no (an ASK is
false, a check found errors, a run failed), and 2 when the command could not be carried out, or its output not written.

What is printed for people names IRIs by prefixes: those of the query or of `--prefix`, the well-known ones, and those that the server's
ontology modules, rule sets and workflows declare. The same prefixes may be used in facts. JSON, CSV, TSV and XML have whole IRIs.
"""
    # those of the simplest command that speaks to a server
    common = rows_of(Help(help_of(programs[0], ["robots"])), "Options")
    parts = ["## Common options\n\n" + table(["option", "takes", "meaning"], common)]
    for program in programs:
        told = Help(help_of(program, []))
        rows = [[f"[`{name}`](#{program.name}-{name})", sentence(cell(text))] for title, pairs in told.sections
                if title not in ("Options", "Positionals") for name, text in pairs]
        section = command_section(program, [], 2, common if program.name == "docent" else [])
        if program.name == "docent-robot":
            section += "\n" + operations_section(program)
        head, _, rest = section.partition("\n")
        parts.append(f"{head}\n\n{sentence(cell(told.description))}\n\n{table(['command', 'purpose'], rows)}{rest}")
    return "# Command line\n" + NOTE + intro + "\n" + "\n".join(parts)


# ---- metrics ----------------------------------------------------------------------------------------------------------------


def metric_families(text):
    """Of what /metrics answers: name → its TYPE, HELP and labels."""
    families = {}
    for line in text.splitlines():
        told = re.match(r"# (HELP|TYPE) (\S+) (.*)", line)
        if told:
            families.setdefault(told[2], {"labels": set()})[told[1]] = told[3].replace("\\n", " ").replace("\\\\", "\\")
            continue
        series = re.match(r"(\w+)(?:\{(.*)\})? ", line)
        name = series and next((n for n in (series[1], re.sub(r"_(bucket|sum|count)$", "", series[1])) if n in families), None)
        if name and series[2]:
            families[name]["labels"] |= set(re.findall(r'(\w+)="', series[2])) - {"le"}
    return families


def metrics_page(text):
    families = metric_families(text)
    rows = [[f"`{name}`", family["TYPE"], ", ".join(f"`{label}`" for label in sorted(family["labels"])),
             sentence(cell(family["HELP"]))] for name, family in sorted(families.items())]
    return "# Metrics\n" + NOTE + """
`http://HOST:PORT/metrics` of a server answers in the text format of Prometheus. A counter only grows until the server
ends. A histogram has the series `_bucket` (with the label `le`), `_sum` and `_count`. Times are in seconds.

""" + table(["metric", "type", "labels", "meaning"], rows)


# ---- limits ------------------------------------------------------------------------------------------------------------------


def number_of(expression):
    plain = re.sub(r"(?<=\d)'(?=\d)", "", expression)
    plain = re.sub(r"\b\w+\{(\d+)\}", r"\1", plain)
    plain = re.sub(r"(?<=\d)[uUlL]+\b", "", plain)
    if not re.fullmatch(r"[\d\s<+*()-]+", plain):
        raise ValueError(f"the limit's value `{expression}` is not a number")
    return eval(plain, {"__builtins__": {}})  # digits and operators alone


def quantity(name, value):
    """A number for people, with the unit that its name ends in."""
    if "bytes" in name.split("_"):
        for bits, unit in MEMORY_UNITS:
            if value >= 1 << bits and value % (1 << bits) == 0:
                return f"{value >> bits} {unit}"
        return f"{value:,} bytes"
    if "ms" in name.split("_"):
        for size, unit in TIME_UNITS:
            if value >= size and value % size == 0:
                return f"{value // size} {unit}"
        return f"{value} ms"
    return f"{value:,}"


def read_limits(text):
    """Of a header: (section, name, number, meaning) of each field of its structs."""
    rows, section, pending = [], "", []
    body = "\n".join(re.findall(r"^struct \w+ \{\n(.*?)^\};", text, re.S | re.M))
    statement = ""
    for line in body.splitlines():
        code, _, comment = line.strip().partition("//")
        comment = comment.strip()
        if not code and not statement:
            if comment:
                pending.append(comment)
            elif pending:
                section, pending = " ".join(pending), []
            continue
        if pending and not pending[-1].endswith("."):
            section, pending = " ".join(pending), []
        statement += " " + code.strip()
        field = re.fullmatch(r"\s*[\w:]+ (\w+)\s*=\s*([^;]+);\s*", statement)
        if field:
            rows.append((section, field[1], number_of(field[2]), " ".join(sentence(text) for text in (comment, " ".join(pending)) if text)))
        if statement.rstrip().endswith((";", "}")):
            statement, pending = "", []
    return rows


# Where the headers are separate only for those who include them: what a heading of the page stands for.
CHAPTERS = {
    "of one query, or one operation of an update": "queries", "of an update": "updates and other servers", "memory of a turn": "turn",
    "rdf/xml documents": "documents", "packed documents": "documents", "run": "workflow", "explain": "explanations", "proof": "explanations",
    "regex": "regular expressions", "rule": "rules and standing queries", "map": "imports of maps", "web": "browser app and live connections",
    "check": "checks", "replay": "replays", "subscription": "subscriptions", "text": "texts", "prefix": "prefixes"}


def limit_headers():
    return sorted((ROOT / "graph/base").glob("*limits.h"), key=lambda p: (p.name != "limits.h", p.name))


def limits_page(metrics):
    """`metrics`: what /metrics answers. A limit's metrics are those that say its name; else, the one of its name."""
    names = {limit[1] for path in limit_headers() for limit in read_limits(path.read_text())}
    seen = {}
    for metric, family in sorted(metric_families(metrics).items()):
        said = names.intersection(re.findall(r"\w+", family["HELP"])) or names.intersection([metric.removeprefix("docent_")])
        for name in said:
            seen.setdefault(name, []).append(f"`{metric}`")
    chapters = {}
    for path in limit_headers():
        of_file = {"limits.h": ""}.get(path.name, path.name.removesuffix("_limits.h"))
        for section, name, value, meaning in read_limits(path.read_text()):
            if not meaning:
                raise ValueError(f"{path}: the limit {name} has no comment that says what it limits")
            heading = (section or of_file).lower()
            chapters.setdefault(CHAPTERS.get(heading, heading), (section or of_file, []))[1].append(
                [f"`{name}`", quantity(name, value), sentence(cell(meaning)), ", ".join(seen.get(name, []))])
    parts = []
    for chapter, (written, rows) in chapters.items():
        title = written if written.lower() == chapter else chapter
        parts.append(f"## {sentence(title).rstrip('.')}\n\n" + table(["limit", "value", "meaning", "[metric](metrics.md)"], rows))
    return "# Limits\n" + NOTE + """
Every queue, loop, query, message and document of Docent has a named limit. An error at a limit gives its name and value. Limits
that the [command line](cli.md#docent-serve) of `docent serve` sets have an option of the same name; the others are fixed when the
program is built. The metrics of a limit show what is charged to it now, or what it refused.

""" + "\n".join(parts)


# ---- findings ---------------------------------------------------------------------------------------------------------------


def findings_page(docent):
    told = json.loads(subprocess.run([docent, "reference"], capture_output=True, text=True, timeout=60, check=True).stdout)
    findings = "\n".join(
        f"### {kind['rule']}\n\n{cell(kind['meaning'])}\n\n*{kind['severity'].capitalize()}, in files of {kind['files']}.* "
        f"{cell(kind['remedy'])}\n".replace("in files of all", "in all files") for kind in told["findings"])
    components = table(["parameter", "component in the report"],
                       [[f"`sh:{c['parameter']}`", f"`sh:{c['component']}ConstraintComponent`"] for c in told["components"]])
    return "# Findings\n" + NOTE + f"""
## docent check

`docent check` reports findings with file, line, column, what is wrong and a remedy. `--json` gives one object a line; its
field `rule` is one of the names below, which do not change between versions. An error makes the exit code 1; with
`--strict` a warning does, too.

{findings}
## docent validate

`docent validate` reports each violation of a SHACL shape with the constraint component that found it
(`sh:sourceConstraintComponent` in the report as RDF). These components are supported.

{components}"""


# ---- ontology -----------------------------------------------------------------------------------------------------------------

MODULES = """PREFIX owl: <http://www.w3.org/2002/07/owl#> SELECT ?graph ?module ?label ?comment ?version { GRAPH ?graph {
    ?module a owl:Ontology ; rdfs:label ?label ; rdfs:comment ?comment OPTIONAL { ?module owl:versionInfo ?version } } } ORDER BY ?module"""
WORDS = """SELECT ?graph ?word ?label ?comment ?kind ?of ?above ?domain ?range { GRAPH ?graph {
    ?word rdfs:label ?label ; rdf:type ?kind . FILTER(STRSTARTS(STR(?word), STR(docent:)))
    OPTIONAL { ?word rdfs:comment ?comment } OPTIONAL { ?word rdfs:subClassOf|rdfs:subPropertyOf ?above }
    OPTIONAL { ?word rdfs:domain ?domain } OPTIONAL { ?word rdfs:range ?range } } }"""
PROPERTY_KINDS = {"owl:ObjectProperty", "owl:DatatypeProperty", "rdf:Property", "owl:AnnotationProperty"}


def ontology_page(server, prefixes):
    """`server`: a stage's server with the modules of ontology/ loaded."""
    def short(iri):
        return next((f"{name}:{iri[len(start):]}" for name, start in prefixes.items() if iri.startswith(start)), f"<{iri}>")

    def rows_of(query):
        return [{name: value["value"] for name, value in row.items() if value["type"] != "bnode"}
                for row in server.sparql(query)["results"]["bindings"]]

    words = {}
    for row in rows_of(WORDS):
        word = words.setdefault(short(row["word"]), {"module": row["graph"], "label": row["label"], "comment": row.get("comment", ""),
                                                     "kind": set(), "above": set(), "domain": set(), "range": set()})
        for field in ("kind", "above", "domain", "range"):
            if field in row:
                word[field].add(short(row[field]))
    parts = []
    for module in rows_of(MODULES):
        own = {name: word for name, word in sorted(words.items()) if word["module"] == module["graph"]}
        classes = [[anchor(name), list_of(word["above"]), cell(word["comment"])] for name, word in own.items()
                   if "owl:Class" in word["kind"]]
        properties = [[anchor(name) + (" *state*" if "docent:StateProperty" in word["kind"] else ""), list_of(word["domain"]),
                       list_of(word["range"]), cell(word["comment"])] for name, word in own.items() if word["kind"] & PROPERTY_KINDS]
        others = [[anchor(name), list_of(word["kind"]), cell(word["comment"])] for name, word in own.items()
                  if "owl:Class" not in word["kind"] and not word["kind"] & PROPERTY_KINDS]
        parts.append(f"## {module['label']}\n\n{cell(module['comment'])}\n\n`{module['module']}`, version {module.get('version', '?')}\n")
        for title, head, rows in (("Classes", ["class", "is a", "meaning"], classes),
                                  ("Properties", ["property", "of", "value", "meaning"], properties),
                                  ("Individuals", ["word", "is a", "meaning"], others)):
            if rows:
                parts.append(f"**{title}**\n\n{table(head, rows)}")
    return "# Ontology\n" + NOTE + """
The words of `https://w3id.org/docent#` (prefix `docent:`), as `/usr/share/docent/ontology/*.ttl` defines them. A property
marked *state* is a state property: a new value replaces the old one that the same source told.

""" + "\n".join(parts)


def anchor(name):
    return f'<a id="{name.partition(":")[2]}"></a>`{name}`'


def list_of(names):
    return ", ".join(f"`{name}`" for name in sorted(names))
