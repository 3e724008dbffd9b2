#include "graph/rdf/formats/turtle_parser.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/limits.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/declared_prefixes.h"
#include "graph/rdf/formats/quad_collector.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

// Parser of one document. A production starts at its first token (white space skipped) and returns false on a
// mistake, which is then in scan_.failure(); the statement loop reports it.
class TurtleParser {
 public:
  TurtleParser(std::string_view text, RdfFormat format, const ParseRdfOptions& options, PlaceRecorder* places)
      : text_(text),
        options_(options),
        line_based_(format == RdfFormat::kNTriples || format == RdfFormat::kNQuads),
        graphs_(format == RdfFormat::kTriG || format == RdfFormat::kNQuads),
        scan_(text, line_based_, options.limits.term_bytes),
        collector_(options.blank_node_scope, options.limits, options.memory),
        base_(options.base_iri),
        places_(places) {}

  ParsedRdf Run() {
    ParsedRdf parsed;
    scan_.SkipLines();
    if (LooksLikeJson()) {
      parsed.diagnostics.push_back({options_.file, SpanAt(text_, scan_.position(), 1),
                                    "this looks like JSON-LD, which is not read",
                                    "Turtle, TriG, N-Triples, N-Quads and RDF/XML are"});
      return parsed;
    }
    while (!scan_.AtEnd() && !too_many_ && parsed.diagnostics.size() < options_.limits.document_diagnostics) {
      if (!Alive() || !collector_.stopped().ok()) break;
      if (!(line_based_ ? LineStatement() : Statement())) {
        if (!stopped_.ok()) break;
        const TurtleScanner::Failure& f = scan_.failure();
        parsed.diagnostics.push_back({options_.file, SpanAt(text_, f.offset, f.length), f.message, f.hint});
        scan_.SkipToNextStatement();
        graph_ = Term();
        depth_ = 0;
      }
      scan_.SkipLines();
    }
    parsed.diagnostics.insert(parsed.diagnostics.end(), refusals_.begin(), refusals_.end());
    parsed.stopped = stopped_.ok() ? collector_.stopped() : stopped_;
    parsed.prefixes = prefixes_.Take();
    if (parsed.ok()) parsed.quads = collector_.TakeQuads();
    return parsed;
  }

  // Parses the statements of a line-based format, one after the other.
  ParsedRdf RunLines(const std::function<bool(const TermQuad&)>& visit) {
    visit_ = &visit;
    return Run();
  }

 private:
  // False: deadline or cancellation ends the document. Polled every few KiB.
  bool Alive() {
    constexpr size_t kBytesALook = 4096;
    if (options_.cancellation == nullptr || scan_.position() < next_look_) return true;
    next_look_ = scan_.position() + kBytesALook;
    stopped_ = options_.cancellation->CheckNow();
    return stopped_.ok();
  }

  // What a prefix takes beside its texts, and what the places of a quad do.
  static constexpr size_t kBytesOfPrefix = 250, kBytesOfPlaces = 300;

  // N-Triples [2] triple, N-Quads [2] statement: subject predicate object graph? '.' end of line
  bool LineStatement() {
    TermQuad& quad = line_;
    quad.graph.lexical.clear();
    if (scan_.TakeKeyword("VERSION", true)) return IsOfRdf12("VERSION is");
    const size_t subject_at = scan_.position();
    if (!ReadSubjectTerm(&quad.subject, "a subject (an IRI or a blank node)")) return false;
    scan_.SkipSpace();
    if (scan_.Peek() != '<') return scan_.Fail("expected the IRI of the predicate", "", true);
    const size_t predicate_at = scan_.position();
    if (!ReadIriTerm(&quad.predicate)) return false;
    scan_.SkipSpace();
    const size_t object_at = scan_.position();
    if (!ReadObjectTerm(&quad.object)) return false;
    scan_.SkipSpace();
    if (graphs_ && scan_.Peek() != '.') {
      const size_t graph_at = scan_.position();
      if (!ReadSubjectTerm(&quad.graph, "a graph name or '.'")) return false;
      LookAtGraph(quad.graph, graph_at);
      scan_.SkipSpace();
    }
    if (!scan_.Take('.')) return scan_.Fail("expected '.' at the end of the statement", "", true);
    scan_.SkipSpace();
    char next = scan_.Peek();
    if (!scan_.AtEnd() && next != '\n' && next != '\r' && next != '#') {
      return scan_.Fail("expected the end of the line after '.'", "write each statement on its own line",
                        true);
    }
    if (visit_ == nullptr) {
      if (!Add(std::move(quad), subject_at, predicate_at, object_at)) return false;
      quad = TermQuad();
    } else if (!(*visit_)(quad)) {
      scan_.SkipAll();
    }
    return true;
  }

  // Reports a construct of RDF 1.2 by its name, at its place. Returns false, as all failed productions.
  bool IsOfRdf12(std::string_view what) {
    return scan_.Fail(
        Concat(what, " of RDF 1.2, which is not read"),
        "RDF 1.1 is: describe a triple with rdf:Statement, rdf:subject, rdf:predicate and rdf:object");
  }
  bool AtTripleTerm() const { return scan_.Peek() == '<' && scan_.Peek(1) == '<'; }

  bool ReadSubjectTerm(Term* term, std::string_view what) {
    if (AtTripleTerm()) return IsOfRdf12("'<<' opens a triple term or a reified triple, which are");
    if (scan_.Peek() == '<') return ReadIriTerm(term);
    if (scan_.Peek() == '_' && scan_.Peek(1) == ':') return ReadLabelledBlank(term);
    return scan_.Fail(Concat("expected ", what), "", true);
  }

  bool ReadObjectTerm(Term* term) {
    if (scan_.Peek() == '"') return ReadLiteral(term);
    return ReadSubjectTerm(term, "an object (an IRI, a blank node or a literal)");
  }

  // Turtle [2] statement, TriG [2] block and directive.
  bool Statement() {
    if (scan_.Peek() == '@') return AtDirective();
    if (scan_.TakeKeyword("VERSION", true)) return IsOfRdf12("VERSION is");
    if (scan_.TakeKeyword("PREFIX", true)) return PrefixDeclaration(false);
    if (scan_.TakeKeyword("BASE", true)) return BaseDeclaration(false);
    if (graphs_) {
      if (scan_.Peek() == '{') return GraphBlock();
      if (scan_.TakeKeyword("GRAPH", true)) return NamedGraph();
    }
    if (scan_.Peek() == '{') {
      return scan_.Fail("'{' opens a graph, which Turtle does not have",
                        "TriG does: name the file .trig; formulas of Notation3 are not read");
    }
    return TriplesOrGraph();
  }

  // True if the text begins as JSON does and Turtle and TriG cannot: "{" and a name, or "[" and "{".
  bool LooksLikeJson() const {
    const size_t open = text_.find_first_not_of(" \t\r\n");
    if (open == std::string_view::npos || (text_[open] != '{' && text_[open] != '[')) return false;
    const size_t next = text_.find_first_not_of(" \t\r\n", open + 1);
    return next != std::string_view::npos && text_[next] == (text_[open] == '{' ? '"' : '{');
  }

  bool AtDirective() {
    size_t at = scan_.position();
    scan_.Take('@');
    if (scan_.TakeDirective("prefix")) return PrefixDeclaration(true);
    if (scan_.TakeDirective("base")) return BaseDeclaration(true);
    if (scan_.TakeDirective("version")) return IsOfRdf12("@version is");
    return scan_.FailAt(at, 1, "unknown directive",
                        "@prefix and @base are known, in lower case; those of Notation3 are not read");
  }

  // @prefix p: <iri> .   or   PREFIX p: <iri>
  bool PrefixDeclaration(bool dot) {
    std::string_view prefix;
    std::string iri;
    scan_.SkipSpace();
    const size_t at = scan_.position();
    if (!scan_.ReadPrefix(&prefix)) return false;
    scan_.SkipSpace();
    if (!ReadResolvedIri(&iri) || !EndDirective(dot)) return false;
    if (!collector_.Charge(prefix.size() + iri.size(), kBytesOfPrefix)) return TooMany();
    if (places_ != nullptr) places_->DeclarePrefix(prefix, iri, at);
    prefixes_.Declare(prefix, std::move(iri));
    return true;
  }

  // @base <iri> .   or   BASE <iri>
  bool BaseDeclaration(bool dot) {
    std::string iri;
    scan_.SkipSpace();
    if (!ReadResolvedIri(&iri) || !EndDirective(dot)) return false;
    base_ = std::move(iri);
    return true;
  }

  bool EndDirective(bool dot) {
    if (!dot) return true;
    scan_.SkipSpace();
    return scan_.Take('.') ||
           scan_.Fail("expected '.' after the declaration", "or write it without '@' and '.'", true);
  }

  // TriG [5g] wrappedGraph: { triples }
  bool GraphBlock() {
    scan_.Take('{');
    scan_.SkipSpace();
    while (!scan_.Take('}')) {
      if (scan_.AtEnd()) return scan_.Fail("expected '}' at the end of the graph");
      if (!Triples()) return false;
      scan_.SkipSpace();
      bool dot = scan_.Take('.');
      scan_.SkipSpace();
      if (!dot && scan_.Peek() != '}') return scan_.Fail("expected '.' or '}' after the triple", "", true);
    }
    graph_ = Term();
    return true;
  }

  // GRAPH label { triples }
  bool NamedGraph() {
    scan_.SkipSpace();
    const size_t at = scan_.position();
    if (!GraphLabel(&graph_)) return false;
    LookAtGraph(graph_, at);
    scan_.SkipSpace();
    if (scan_.Peek() != '{') return scan_.Fail("expected '{' after the name of the graph", "", true);
    return GraphBlock();
  }

  // A graph that is not taken is a mistake; the document is read on.
  void LookAtGraph(const Term& graph, size_t at) {
    if (!options_.refuse_graph || refusals_.size() >= options_.limits.document_diagnostics) return;
    if (std::string why = options_.refuse_graph(graph); !why.empty())
      refusals_.push_back({options_.file, SpanAt(text_, at, scan_.position() - at), std::move(why), ""});
  }

  bool GraphLabel(Term* label) {
    if (scan_.Peek() == '[') {
      scan_.Take('[');
      scan_.SkipSpace();
      if (!scan_.Take(']'))
        return scan_.Fail("expected ']'", "a graph is named by an IRI, _:label or []", true);
      *label = collector_.NewBlank();
      return true;
    }
    if (scan_.Peek() == '_' && scan_.Peek(1) == ':') return ReadLabelledBlank(label);
    return ReadIriTerm(label);
  }

  // Turtle [6] triples '.', or TriG [3g]: a label with a graph block behind it.
  bool TriplesOrGraph() {
    if (graphs_ && scan_.Peek() != '(') {
      const size_t at = scan_.position();
      Term first;
      bool anonymous = scan_.Peek() == '[';
      bool property_list = false;
      if (anonymous ? !BlankNodePropertyList(&first, &property_list) : !ReadSubject(&first)) return false;
      scan_.SkipSpace();
      if (scan_.Peek() == '{' && !property_list) {
        LookAtGraph(first, at);
        graph_ = first;
        return GraphBlock();
      }
      bool may_end = property_list && scan_.Peek() == '.';
      if (!may_end && !PredicateObjectList(first, at)) return false;
    } else if (!Triples()) {
      return false;
    }
    scan_.SkipSpace();
    return scan_.Take('.') ||
           scan_.Fail("expected '.' at the end of the statement",
                      "';' goes on with the same subject, ',' with the same predicate", true);
  }

  // Turtle [6] triples, without the '.'.
  bool Triples() {
    const size_t at = scan_.position();
    Term subject;
    bool property_list = false;
    if (scan_.Peek() == '[') {
      if (!BlankNodePropertyList(&subject, &property_list)) return false;
    } else if (scan_.Peek() == '(') {
      if (!Collection(&subject)) return false;
    } else if (!ReadSubject(&subject)) {
      return false;
    }
    scan_.SkipSpace();
    if (property_list && (scan_.Peek() == '.' || scan_.Peek() == '}')) return true;
    return PredicateObjectList(subject, at);
  }

  bool ReadSubject(Term* subject) {
    char c = scan_.Peek();
    if (c == '"' || c == '\'' || scan_.AtNumber()) return scan_.Fail("a literal can't be a subject");
    if (c == '_' && scan_.Peek(1) == ':') return ReadLabelledBlank(subject);
    return ReadIriTerm(subject);
  }

  // Turtle [7]: verb objectList (';' (verb objectList)?)*
  bool PredicateObjectList(const Term& subject, size_t subject_at) {
    while (true) {
      const size_t predicate_at = scan_.position();
      Term predicate;
      if (scan_.TakeKeyword("a", false)) {
        predicate = Term::Iri(std::string(kRdfType));
      } else if (scan_.Peek() == '_' && scan_.Peek(1) == ':') {
        return scan_.Fail("a blank node can't be a predicate");
      } else if (scan_.Peek() == '"' || scan_.Peek() == '\'' || scan_.AtNumber()) {
        return scan_.Fail("a literal can't be a predicate");
      } else if (!ReadIriTerm(&predicate)) {
        return false;
      }
      do {
        scan_.SkipSpace();
        if (!Object(subject, predicate, subject_at, predicate_at)) return false;
        scan_.SkipSpace();
        if (scan_.Peek() == '{' && scan_.Peek(1) == '|')
          return IsOfRdf12("'{|' opens an annotation, which is");
        if (scan_.Peek() == '~') return IsOfRdf12("'~' names a reifier, which is");
      } while (scan_.Take(','));
      if (scan_.Peek() != ';') return true;
      while (scan_.Take(';')) scan_.SkipSpace();
      char c = scan_.Peek();
      if (c == '.' || c == ']' || c == '}' || scan_.AtEnd()) return true;
    }
  }

  bool Object(const Term& subject, const Term& predicate, size_t subject_at, size_t predicate_at) {
    const size_t object_at = scan_.position();
    Term object;
    if (!Alive() || !ReadObject(&object)) return false;
    return Add({subject, predicate, std::move(object), graph_}, subject_at, predicate_at, object_at);
  }

  bool Add(TermQuad quad, size_t subject_at, size_t predicate_at, size_t object_at) {
    if (!collector_.Add(std::move(quad))) return TooMany();
    if (places_ != nullptr && !collector_.Charge(0, kBytesOfPlaces)) return TooMany();
    if (places_ != nullptr) places_->AddQuad(subject_at, predicate_at, object_at);
    return true;
  }

  bool TooMany() {
    too_many_ = true;
    return scan_.Fail(collector_.Refusal(), "split the document");
  }

  bool ReadObject(Term* object) {
    char c = scan_.Peek();
    if (c == '[') {
      bool property_list;
      return BlankNodePropertyList(object, &property_list);
    }
    if (c == '(') return Collection(object);
    if (c == '"' || c == '\'') return ReadLiteral(object);
    if (c == '_' && scan_.Peek(1) == ':') return ReadLabelledBlank(object);
    if (scan_.AtNumber()) {
      std::string_view lexical, datatype;
      if (!scan_.ReadNumber(&lexical, &datatype)) return false;
      *object = Term::Literal(std::string(lexical), std::string(datatype));
      return true;
    }
    for (bool value : {true, false}) {
      if (scan_.TakeKeyword(value ? "true" : "false", false)) {
        *object = Term::Boolean(value);
        return true;
      }
    }
    return ReadIriTerm(object);
  }

  // Turtle [14]: '[' predicateObjectList ']', or ANON: '[' ']'.
  bool BlankNodePropertyList(Term* node, bool* property_list) {
    if (!Deeper()) return false;
    const size_t at = scan_.position();
    scan_.Take('[');
    scan_.SkipSpace();
    *node = collector_.NewBlank();
    *property_list = scan_.Peek() != ']';
    if (*property_list && !PredicateObjectList(*node, at)) return false;
    scan_.SkipSpace();
    --depth_;
    return scan_.Take(']') || scan_.Fail("expected ']'", "", true);
  }

  // Turtle [15]: '(' object* ')'.
  bool Collection(Term* head) {
    if (!Deeper()) return false;
    scan_.Take('(');
    scan_.SkipSpace();
    const Term first = Term::Iri(Concat(kRdfNs, "first")), rest = Term::Iri(Concat(kRdfNs, "rest"));
    const Term nil = Term::Iri(Concat(kRdfNs, "nil"));
    Term last;
    *head = nil;
    while (!scan_.Take(')')) {
      if (scan_.AtEnd()) return scan_.Fail("expected ')' at the end of the collection");
      const size_t at = scan_.position();
      Term node = collector_.NewBlank();
      if (last.lexical.empty()) {
        *head = node;
      } else if (!Add({last, rest, node, graph_}, at, at, at)) {
        return false;
      }
      last = node;
      if (!Object(node, first, at, at)) return false;
      scan_.SkipSpace();
    }
    const size_t end = scan_.position();
    if (!last.lexical.empty() && !Add({last, rest, nil, graph_}, end, end, end)) return false;
    --depth_;
    return true;
  }

  bool Deeper() {
    if (++depth_ <= options_.limits.turtle_nesting) return true;
    return scan_.Fail("brackets nested deeper than the limit turtle_nesting = " +
                      std::to_string(options_.limits.turtle_nesting));
  }

  bool ReadLabelledBlank(Term* term) {
    std::string_view label;
    if (!scan_.ReadBlankLabel(&label)) return false;
    *term = collector_.NamedBlank(label);
    return true;
  }

  bool ReadLiteral(Term* term) {
    std::string value;
    if (!scan_.ReadString(&value)) return false;
    scan_.SkipSpaceWithinLiteral();
    if (scan_.Peek() == '@') {
      std::string_view language;
      if (!scan_.ReadLanguage(&language)) return false;
      *term = Term::LangString(std::move(value), std::string(language));
      return true;
    }
    if (scan_.Peek() != '^') {
      *term = Term::Literal(std::move(value));
      return true;
    }
    Term datatype;
    if (scan_.Peek(1) != '^') return scan_.Fail("expected '^^' before the datatype");
    scan_.Take('^');
    scan_.Take('^');
    scan_.SkipSpace();
    size_t at = scan_.position();
    if (!ReadIriTerm(&datatype)) return false;
    if (datatype.lexical == kRdfLangString) {
      return scan_.FailAt(at, 1, "rdf:langString needs a language tag", "write \"text\"@en");
    }
    *term = Term::Literal(std::move(value), std::move(datatype.lexical));
    return true;
  }

  // An IRI in <>, or a prefixed name (not in line-based formats).
  bool ReadIriTerm(Term* term) {
    term->kind = TermKind::kIri;
    term->datatype.clear();
    term->language.clear();
    if (AtTripleTerm()) return IsOfRdf12("'<<' opens a triple term or a reified triple, which are");
    if (scan_.Peek() == '<') return ReadResolvedIri(&term->lexical);
    if (line_based_) return scan_.Fail("expected an IRI in <>", "", true);
    size_t at = scan_.position();
    std::string_view prefix;
    std::string local;
    if (!scan_.ReadPrefixedName(&prefix, &local)) return false;
    const std::string* known = prefixes_.Find(prefix);
    if (known == nullptr) return UnknownPrefix(at, prefix);
    if (places_ != nullptr) places_->UsePrefix(prefix);
    term->lexical = *known + local;
    return CheckLength(at, term->lexical);
  }

  // Checks the length of an IRI that is longer than its written form.
  bool CheckLength(size_t at, const std::string& iri) {
    const size_t limit = options_.limits.term_bytes;
    return iri.size() <= limit ||
           scan_.FailAt(at, 1,
                        absl::StrCat("this IRI has ", iri.size(),
                                     " bytes, written out; the limit term_bytes is ", limit));
  }

  bool UnknownPrefix(size_t at, std::string_view prefix) {
    std::string hint = Concat("declare it: @prefix ", prefix, ": <…> .");
    for (const auto& [name, ns] : kWellKnownPrefixes) {
      if (name == prefix) hint = Concat("declare it: @prefix ", prefix, ": <", ns, "> .");
    }
    constexpr size_t kMostCompared = 1000;
    std::string nearest = Nearest(prefix, prefixes_.Names(kMostCompared));
    if (!nearest.empty()) hint = Concat("did you mean ", nearest, ":? Else ", hint);
    return scan_.FailAt(at, prefix.size() + 1, Concat("the prefix '", prefix, ":' is not declared"),
                        std::move(hint));
  }

  bool ReadResolvedIri(std::string* iri) {
    if (scan_.Peek() != '<') return scan_.Fail("expected an IRI in <>", "", true);
    size_t at = scan_.position();
    if (!scan_.ReadIri(iri)) return false;
    if (IsAbsoluteIri(*iri)) return true;
    const std::string reference = *iri;
    if (line_based_) {
      return scan_.FailAt(at, 1, Concat("<", reference, "> is not an absolute IRI"),
                          "this format has no relative IRIs");
    }
    if (!IsAbsoluteIri(base_)) {
      return scan_.FailAt(at, 1, Concat("<", reference, "> is relative and the document has no base IRI"),
                          "write the whole IRI, or declare @base <…> .");
    }
    *iri = ResolveIri(reference, base_);
    return CheckLength(at, *iri);
  }

  std::string_view text_;
  const ParseRdfOptions& options_;
  bool line_based_;
  bool graphs_;
  TurtleScanner scan_;
  QuadCollector collector_;
  bool too_many_ = false;  // quads
  std::string base_;
  PlaceRecorder* places_;                                        // may be null
  const std::function<bool(const TermQuad&)>* visit_ = nullptr;  // RunLines
  TermQuad line_;
  Term graph_;            // of the current block; empty outside
  Diagnostics refusals_;  // of graphs
  DeclaredPrefixes prefixes_;
  int depth_ = 0;
  size_t next_look_ = 0;  // offset at which cancellation is polled next
  absl::Status stopped_;  // error of the cancellation
};

}  // namespace

ParsedRdf ParseTurtleFamily(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                            PlaceRecorder* places) {
  return TurtleParser(text, format, options, places).Run();
}

ParsedRdf ParseTurtleLines(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                           const std::function<bool(const TermQuad&)>& visit) {
  return TurtleParser(text, format, options, nullptr).RunLines(visit);
}

}  // namespace docent
