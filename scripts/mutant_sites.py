"""Places in C++ sources where one small change can be made, found in the syntax tree of libclang.

A change is a comparison, a boolean, a constant, or a call left out. What is found in a file is kept in a cache by the file's
text. Whether the changes that were drawn still compile is tried in memory.
"""
import hashlib
import json
import re
import shlex

VERSION = 6  # of what is kept
KINDS = ("comparison", "boolean", "constant", "call")
COMPARED = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
# Calls that change nothing that a test could see: room made in advance, and lines of the program's log.
UNSEEN = re.compile(rb"(\.|->)(reserve|shrink_to_fit)\(|^spdlog::")
# At least as many as a file has of each kind, without a parse.
ROUGHLY = {"comparison": re.compile(rb"[<>]=?|[!=]="), "boolean": re.compile(rb"&&|\|\||!|true|false|if |\?"),
           "constant": re.compile(rb"\b[0-9]"), "call": re.compile(rb"\) *;")}
# What a macro is given is left alone: its extents are not those of the text.
MACRO = re.compile(rb"\b[A-Z][A-Z0-9_]{3,}\([^;{]*")


class Site:
    """One change in a file: bytes start..end become `pieces`, where a piece is new text or a span of the old text."""

    def __init__(self, kind, start, end, pieces, extra=None):
        self.kind, self.start, self.end, self.pieces, self.extra = kind, start, end, pieces, extra

    def as_json(self):
        return [self.kind, self.start, self.end, self.pieces, self.extra]


class Finder:
    """Walks the tree of one file."""

    def __init__(self, path, source):
        self.path, self.source, self.sites, self.macros = str(path), source, [], []

    def text(self, cursor):
        return self.source[cursor.extent.start.offset:cursor.extent.end.offset]

    def span(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def add(self, kind, start, end, pieces, extra=None):
        if start < end and not any(start < b and a < end and not (start <= a and b <= end) for a, b in self.macros) \
                and not any(a <= start and end <= b for a, b in self.macros):
            self.sites.append(Site(kind, start, end, pieces, extra))

    def walk(self, cursor, parents=()):
        kind = cursor.kind.name
        if cursor.location.file and cursor.location.file.name != self.path:
            return
        if kind in ("STATIC_ASSERT", "ENUM_DECL", "FIELD_DECL"):  # most values of fields are written over
            return
        children = list(cursor.get_children())
        if kind in ("BINARY_OPERATOR", "CALL_EXPR"):
            self.binary(children)
        elif kind == "UNARY_OPERATOR" and self.text(cursor).startswith(b"!") and not self.text(cursor).startswith(b"!="):
            a, b = self.span(cursor)
            self.add("boolean", a, b, ["static_cast<bool>(", [a + 1, b], ")"])
        elif kind == "CXX_BOOL_LITERAL_EXPR":
            other = {b"true": "false", b"false": "true"}.get(self.text(cursor))
            if other:
                self.add("boolean", *self.span(cursor), [other], self.constexpr(parents))
        elif kind in ("INTEGER_LITERAL", "FLOATING_LITERAL"):
            if re.fullmatch(rb"[0-9][0-9a-fA-FxX'.]*(e-?[0-9]+)?[uUlLfF]*", self.text(cursor)):
                self.add("constant", *self.span(cursor), ["(", list(self.span(cursor)), " + 1)"], self.constexpr(parents))
        elif kind in ("IF_STMT", "WHILE_STMT", "CONDITIONAL_OPERATOR"):
            self.condition(kind, children)
        if kind == "COMPOUND_STMT":
            for child in children:
                self.call(child)
        elif kind in ("IF_STMT", "FOR_STMT", "CXX_FOR_RANGE_STMT", "WHILE_STMT"):
            for child in children[1:]:
                self.call(child)
        for child in children[1:] if kind == "CASE_STMT" else children:
            self.walk(child, (*parents[-12:], cursor))

    def binary(self, children):
        if len(children) == 3 and self.text(children[1]) in (*map(str.encode, COMPARED), b"&&", b"||"):
            children = [children[0], children[2]]
        if len(children) != 2:
            return
        (a, b), (c, d) = sorted(map(self.span, children))
        if not a < b <= c < d:
            return
        written = re.sub(rb"//[^\n]*|/\*.*?\*/|\s", b"", self.source[b:c]).decode(errors="replace")
        if written in COMPARED:
            choice = COMPARED[written]
            new = choice[(a + d) % len(choice)]  # either neighbour, the same one each time
            self.add("comparison", a, d, [[a, b], f" {new} ", [c, d]])
        elif written in ("&&", "||"):
            new = "||" if written == "&&" else "&&"
            self.add("boolean", a, d, ["(", [a, b], f") {new} (", [c, d], ")"])

    # `if (called())` becomes `if (!called())`; what has a site of its own (!x, a < b, a && b) is left to that.
    def condition(self, kind, children):
        for child in children:
            if child.kind.name in ("DECL_STMT", "VAR_DECL"):
                continue
            a, b = self.span(child)
            before, after = self.source[:a].rstrip()[-1:], self.source[b:].lstrip()[:1]
            inner = child
            while inner.kind.name in ("UNEXPOSED_EXPR", "PAREN_EXPR") and len(list(inner.get_children())) == 1:
                inner = next(inner.get_children())
            written = self.source[a:b]
            closed = (before in (b"(", b";") and after == b")") or kind == "CONDITIONAL_OPERATOR"
            simple = not re.search(rb"[<>=!&|]=?|==", re.sub(rb"->|<[\w:]+>", b"", written))
            if closed and simple and inner.kind.name in ("CALL_EXPR", "DECL_REF_EXPR", "MEMBER_REF_EXPR"):
                self.add("boolean", a, b, ["!(", [a, b], ")"])
            return

    def call(self, cursor):
        inner = cursor
        while inner.kind.name == "UNEXPOSED_EXPR" and len(list(inner.get_children())) == 1:
            inner = next(inner.get_children())
        if inner.kind.name != "CALL_EXPR" or inner.spelling.startswith("operator"):
            return
        a, b = self.span(cursor)
        if self.source[b:].lstrip()[:1] == b";" and not UNSEEN.search(self.source[a:b]):
            self.add("call", a, b, ["void()"])

    # A constant that the compiler knows becomes one that the run decides; null where it is none.
    def constexpr(self, parents):
        for depth, cursor in enumerate(reversed(parents)):
            if cursor.kind.name in ("COMPOUND_STMT",):
                return None
            if cursor.kind.name == "VAR_DECL":
                a = self.source.rfind(b"constexpr", max(0, cursor.extent.start.offset - 20), cursor.extent.end.offset)
                if a < 0 or b";" in self.source[a:cursor.extent.start.offset]:
                    return None
                above = parents[len(parents) - depth - 2].kind.name if len(parents) - depth >= 2 else ""
                return [a, a + 9, "inline const" if above in ("CLASS_DECL", "STRUCT_DECL") else "const"]
        return None


def render(source, sites, numbered):
    """The source with the sites in it; `numbered(site)` is the text that a site's change is guarded by."""
    edits = {tuple(s.extra[:2]): s.extra[2] for s in sites if s.extra}

    def out(start, end, inside):
        result, at = [], start
        inside = sorted(inside, key=lambda s: (s.start, -s.end))
        while inside:
            site, inside = inside[0], inside[1:]
            below = [s for s in inside if s.start >= site.start and s.end <= site.end]
            inside = [s for s in inside if s not in below]
            result.append(plain(at, site.start))
            changed = "".join(p if isinstance(p, str) else
                              out(p[0], p[1], [s for s in below if s.start >= p[0] and s.end <= p[1]]) for p in site.pieces)
            same = out(site.start, site.end, below)
            if site.kind == "call":
                same = f"void({same})"
            result.append(f"({numbered(site)} ? ({changed}) : ({same}))".replace("(void())", "void()"))
            at = site.end
        return "".join(result) + plain(at, end)

    def plain(start, end):
        text, at = "", start
        for (a, b), new in sorted(edits.items()):
            if start <= a and b <= end:
                text, at = text + source[at:a].decode() + new, b
        return text + source[at:end].decode()

    return out(0, len(source), sites)


def parsed(path, arguments):
    import clang.cindex as clang
    return clang.Index.create(excludeDecls=True).parse(str(path), arguments)


def sites_of(path, arguments):
    """[kind, start, end, pieces, extra] of each change in the file, whether it compiles or not."""
    finder = Finder(path, path.read_bytes())
    finder.macros = [m.span() for m in MACRO.finditer(finder.source)]
    for cursor in parsed(path, arguments).cursor.get_children():
        finder.walk(cursor)
    unique = {(s.start, s.end, s.kind): s.as_json() for s in finder.sites}
    return sorted(unique.values(), key=lambda s: s[1:3])


def faulty(path, arguments, sites):
    """Those of the sites that do not compile beside each other."""
    unit, source, found = parsed(path, arguments), path.read_bytes(), []

    def faults(text):
        unit.reparse([(str(path), text)])
        return [d for d in unit.diagnostics if d.severity >= 3 and d.location.file and d.location.file.name == str(path)]

    base = {(d.spelling, d.location.line) for d in faults(source.decode())}
    names = {id(site): f"DocentMutant({number})" for number, site in enumerate(sites)}
    while True:
        text = render(source, sites, lambda s: names[id(s)]).encode()
        bad = [d.location.offset for d in faults(text.decode()) if (d.spelling, d.location.line) not in base]
        if not bad:
            return found
        if not sites:
            raise SystemExit(f"mutants: {path} does not compile with libclang")
        for offset in bad:
            before = {s: text.rfind(names[id(s)].encode(), 0, offset) for s in sites}
            guilty = max((s for s in sites if before[s] >= 0), key=before.get, default=None)
            for site in [guilty] if guilty else [s for s in sites if s.extra] or sites[:1]:
                if site in sites:
                    found.append(site)
        sites = [s for s in sites if s not in found]


def arguments_of(entry):
    """What of a compile command a parse needs."""
    words, kept = shlex.split(entry["command"]), ["-x", "c++", "-DDocentMutant(n)=(*(volatile bool*)(n))"]
    for word, following in zip(words, words[1:] + [""]):
        if word.startswith(("-I", "-D", "-std")):
            kept.append(word)
        elif word == "-isystem":
            kept += [word, following]
    return kept


class Sources:
    """The files that changes are made in; one is parsed when it is first asked for."""

    def __init__(self, root, build, folders, cache):
        self.root, self.cache, self.known = root, cache, {}
        self.commands = {e["file"]: e for e in json.loads((build / "compile_commands.json").read_text())}
        self.files = sorted(f for folder in folders for f in (root / folder).rglob("*.cc") if str(f) in self.commands)
        self.precompiled = {}
        cache.mkdir(parents=True, exist_ok=True)

    def keyed(self, file):
        """{key: site} of a file. A key is the file, the line's text and the change, and never the line's number."""
        if file not in self.known:
            kept = self.cache / f"{file.stem}-{mixed(VERSION, file.read_bytes())[:24]}.json"
            if not kept.exists():
                kept.write_text(json.dumps(sites_of(file, self.arguments(file))))
            sites = [Site(*s) for s in json.loads(kept.read_text())]
            self.known[file] = keyed(file.relative_to(self.root).as_posix(), file.read_bytes(), sites)
        return self.known[file]

    def faulty(self, name, sites):
        """Those of the sites of the file (a path in the tree) that do not compile; asked once for each file and choice."""
        file = self.root / name
        kept = self.cache / f"{file.stem}-{mixed(file.read_bytes(), [s.as_json() for s in sites])[:24]}.faulty"
        if not kept.exists():
            found = faulty(file, self.arguments(file), sites)
            kept.write_text(json.dumps([sites.index(s) for s in found]))
        return [sites[i] for i in json.loads(kept.read_text())]

    def arguments(self, file):
        """With all that the files of the folder include read before, once."""
        import clang.cindex as clang
        folder, arguments = file.parent, arguments_of(self.commands[str(file)])
        if folder not in self.precompiled:
            includes = sorted({line for f in folder.glob("*.cc") for line in f.read_text().splitlines() if line.startswith("#include")})
            header, path = self.cache / f"{folder.name}.h", self.cache / f"{folder.name}.pch"
            header.write_text("\n".join(includes) + "\n")
            clang.Index.create().parse(str(header), arguments, options=0x02 | 0x40).save(str(path))  # without bodies
            self.precompiled[folder] = path
        return [*arguments, "-include-pch", str(self.precompiled[folder])]

    def draw(self, seed):
        """Yields (key, file, site) in a random order in which the four kinds take turns. Each change is as likely as any
        other of its kind, and edits elsewhere do not change the order."""
        heaps = [iter(sorted((mixed(seed, kind, f.relative_to(self.root), i), f, i) for f in self.files
                             for i in range(len(ROUGHLY[kind].findall(f.read_bytes()))))) for kind in KINDS]
        while heaps:
            for kind, heap in zip(KINDS, list(heaps)):
                for _, file, i in heap:
                    own = sorted((k for k in self.keyed(file) if f"| {kind}: " in k), key=lambda k: mixed(seed, k))
                    if i < len(own):
                        yield own[i], file.relative_to(self.root).as_posix(), self.known[file][own[i]]
                        break
                else:
                    return


def mixed(*words):
    return hashlib.sha256(" ".join(map(str, words)).encode()).hexdigest()


def shortened(text):
    return text if len(text) <= 100 else f"{text[:60]} ... {text[-35:]}"


def keyed(name, source, sites):
    result = {}
    for site in sites:
        line = source[source.rfind(b"\n", 0, site.start) + 1:].split(b"\n")[0].decode().strip()
        old = " ".join(source[site.start:site.end].decode().split())
        new = " ".join("".join(p if isinstance(p, str) else source[p[0]:p[1]].decode() for p in site.pieces).split())
        change = f"{site.kind}: {shortened(old)} -> {'(left out)' if site.kind == 'call' else shortened(new)}"
        key, again = f"{name} | {line} | {change}", 2
        while key in result:
            key = f"{name} | {line} | {change} | #{again}"
            again += 1
        result[key] = site
    return result
