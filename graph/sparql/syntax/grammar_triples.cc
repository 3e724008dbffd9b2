#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/grammar.h"

namespace docent::sparql {
namespace {

constexpr std::string_view kRdfFirst = "http://www.w3.org/1999/02/22-rdf-syntax-ns#first";
constexpr std::string_view kRdfRest = "http://www.w3.org/1999/02/22-rdf-syntax-ns#rest";
constexpr std::string_view kRdfNil = "http://www.w3.org/1999/02/22-rdf-syntax-ns#nil";

constexpr size_t kBytesOfLabel = 120;  // in a map
constexpr size_t kQuadsAtOnce = 256;   // of an update, before they are taken

PatternTerm IriTerm(std::string_view iri) {
  return PatternTerm::Of(Term::Iri(std::string(iri)));
}

Path PathOf(Term iri) {
  Path path;
  path.iri = std::move(iri);
  return path;
}

Path PathOf(Path::Kind kind, Path child) {
  Path path;
  path.kind = kind;
  path.children.push_back(std::move(child));
  return path;
}

}  // namespace

void Grammar::Give(PatternTerm* from, bool keep, PatternTerm* to) {
  if (keep) {
    ChargeCopy(*from);
    *to = *from;
  } else {
    *to = std::move(*from);
  }
}

std::optional<std::vector<TriplePattern>> Grammar::TemplateInBraces() {
  if (!Expect("{", "before triples")) return std::nullopt;
  TriplesSink sink;
  sink.template_mode = true;
  bool ok = true;
  while (!At("}") && Peek().kind != TokenKind::kEnd) {
    if (!TriplesSameSubject(&sink)) {
      ok = false;
      RecoverInGroup();
      continue;
    }
    if (!Accept(".") && !At("}")) {
      Expected("'.' between triples, or '}'");
      ok = false;
      RecoverInGroup();
    }
  }
  if (!Expect("}", "after the triples") || !ok) return std::nullopt;
  return std::move(sink.triples);
}

PatternTerm Grammar::NewBlank(const SourceSpan& span, bool template_mode) {
  const std::string label = "." + std::to_string(counter_++);  // labels in a text never begin with a dot
  if (template_mode) return PatternTerm::Of(Term::Blank(label), span);
  return PatternTerm::Of(Variable{".b" + label}, span);
}

bool Grammar::LabelledBlank(const Token& token, bool template_mode, PatternTerm* out) {
  if (template_mode) {
    out->Set(Term::Blank(std::string(token.text)));
    return true;
  }
  const auto [it, added] = blank_bgp_.emplace(std::string(token.text), bgp_);
  if (added) Charge(kBytesOfLabel);
  if (it->second != bgp_) {
    Error(token.span, Concat("_:", token.text, " was used in another basic graph pattern"),
          "a blank node means something within one block of triples only; use a variable");
    return false;
  }
  out->Set(Variable{Concat(".b", token.text)});
  return true;
}

bool Grammar::TriplesSameSubject(TriplesSink* sink) {
  const bool brackets = At("(") || At("[");
  const bool complete = brackets && !Peek(1).Is(At("(") ? ")" : "]");  // ( 1 2 ), [ :p 5 ]
  PatternTerm subject;
  if (brackets ? !GraphNode(sink, &subject) : !VarOrTerm(sink, &subject)) return false;
  if (complete && (At(".") || At("}"))) return true;
  return PropertyListNotEmpty(&subject, sink);
}

// An IRI, or "a", without a path operator after it.
bool Grammar::AtPlainVerb() {
  const Token& verb = Peek();
  const bool iri = verb.kind == TokenKind::kIri || verb.kind == TokenKind::kPrefixedName;
  if (!iri && !verb.IsA()) return false;
  const Token& next = Peek(1);
  return next.kind != TokenKind::kPunctuation ||
         std::string_view("/|*+?").find(next.text[0]) == std::string_view::npos;
}

bool Grammar::PropertyListNotEmpty(PatternTerm* subject, TriplesSink* sink) {
  while (true) {
    if (!Property(subject, sink)) return false;
    if (!Accept(";")) return true;
    while (Accept(";")) {
    }
    const Token& next = Peek();
    const bool verb_follows = next.kind == TokenKind::kVariable || next.kind == TokenKind::kIri ||
                              next.kind == TokenKind::kPrefixedName || next.IsA() || next.Is("^") ||
                              next.Is("!") || next.Is("(");
    if (!verb_follows) return true;
  }
}

bool Grammar::Property(PatternTerm* subject, TriplesSink* sink) {
  if (Peek().kind != TokenKind::kVariable && !sink->template_mode && !AtPlainVerb()) {
    PatternTerm verb;
    verb.span = Peek().span;
    std::optional<Path> path = ParsePath();
    if (!path) return false;
    if (path->kind != Path::Kind::kIri) return ObjectList(subject, &*path, &verb, sink);
    verb.Set(std::move(path->iri));  // one in parentheses
    return ObjectList(subject, nullptr, &verb, sink);
  }
  if (sink->triples.empty()) sink->triples.reserve(4);
  TriplePattern& triple = sink->triples.emplace_back();  // filled in place
  const bool verb = Verb(&triple.predicate);
  const bool brackets = verb && (At("(") || At("["));
  if (!verb || brackets || !CountTriple(sink->template_mode) || !VarOrTerm(sink, &triple.object)) {
    PatternTerm before_brackets = std::move(triple.predicate);
    sink->triples.pop_back();
    return brackets && ObjectList(subject, nullptr, &before_brackets, sink);
  }
  const bool more_objects = At(",");
  Give(subject, more_objects || At(";"), &triple.subject);
  if (!more_objects) return true;
  Drop();
  ChargeCopy(triple.predicate);
  PatternTerm again = triple.predicate;
  return ObjectList(subject, nullptr, &again, sink);
}

bool Grammar::Verb(PatternTerm* out) {
  const Token& token = Peek();
  out->span = token.span;
  if (token.kind == TokenKind::kVariable) {
    out->SetVariable(token.text);
    Drop();
    return true;
  }
  if (!token.IsA()) return IriText(out->SetIri());
  Charge(kRdfType.size() + kBytesOfAllocation);
  Drop();
  *out->SetIri() = std::string(kRdfType);
  return true;
}

bool Grammar::ObjectList(PatternTerm* subject, const Path* path, PatternTerm* verb, TriplesSink* sink) {
  do {
    if (path == nullptr && !CountTriple(sink->template_mode)) return false;
    if (sink->quads != nullptr && sink->triples.size() >= kQuadsAtOnce) TakeQuads(sink);
    if (path != nullptr || At("(") ||
        At("[")) {  // the content of brackets gives triples of its own, before this one
      PatternTerm object;
      if (!GraphNode(sink, &object)) return false;
      if (path != nullptr) {
        TranslatePath(*subject, *path, object, sink);
      } else {
        ChargeCopy(*subject);
        ChargeCopy(*verb);
        sink->triples.emplace_back(*subject, *verb, std::move(object));
      }
      continue;
    }
    TriplePattern& triple = sink->triples.emplace_back();
    if (!VarOrTerm(sink, &triple.object)) {
      sink->triples.pop_back();
      return false;
    }
    const bool more_objects = At(",");
    Give(subject, more_objects || At(";"), &triple.subject);
    Give(verb, more_objects, &triple.predicate);
  } while (Accept(","));
  return true;
}

bool Grammar::GraphNode(TriplesSink* sink, PatternTerm* out) {
  if (At("(") && !Peek(1).Is(")")) return Collection(sink, out);
  if (At("[") && !Peek(1).Is("]")) return BlankNodePropertyList(sink, out);
  return VarOrTerm(sink, out);
}

bool Grammar::Collection(TriplesSink* sink, PatternTerm* out) {
  Nested nested(this);
  if (!nested.ok()) return false;
  const SourceSpan span = Take().span;
  PatternTerm cell = NewBlank(span, sink->template_mode);
  *out = cell;
  while (true) {
    PatternTerm item;
    if (!CountTriple(sink->template_mode) || !CountTriple(sink->template_mode) || !GraphNode(sink, &item))
      return false;
    Charge(2 * (kRdfFirst.size() + kBytesOfAllocation));
    sink->triples.push_back({cell, IriTerm(kRdfFirst), std::move(item)});
    if (Accept(")")) break;
    PatternTerm next = NewBlank(span, sink->template_mode);
    sink->triples.push_back({cell, IriTerm(kRdfRest), next});
    cell = std::move(next);
  }
  sink->triples.push_back({cell, IriTerm(kRdfRest), IriTerm(kRdfNil)});
  return true;
}

bool Grammar::BlankNodePropertyList(TriplesSink* sink, PatternTerm* out) {
  Nested nested(this);
  if (!nested.ok()) return false;
  *out = NewBlank(Take().span, sink->template_mode);
  PatternTerm subject = *out;
  return PropertyListNotEmpty(&subject, sink) && Expect("]", "to close the blank node");
}

bool Grammar::VarOrTerm(TriplesSink* sink, PatternTerm* out) {
  const Token& token = Peek();
  out->span = token.span;
  if (token.kind == TokenKind::kVariable) {
    out->SetVariable(token.text);
    Drop();
    return true;
  }
  const bool iri = token.kind == TokenKind::kIri || token.kind == TokenKind::kPrefixedName;
  return iri ? IriText(out->SetIri()) : OtherTerm(sink, out);
}

// A term that is neither variable nor IRI.
bool Grammar::OtherTerm(TriplesSink* sink, PatternTerm* out) {
  const Token& token = Peek();
  switch (token.kind) {
    case TokenKind::kBlankLabel: {
      const Token label = Take();
      return LabelledBlank(label, sink->template_mode, out);
    }
    case TokenKind::kPunctuation:
      if (token.Is("[")) {
        Drop();
        if (!Expect("]", "after '['")) return false;
        *out = NewBlank(out->span, sink->template_mode);
        return true;
      }
      if (token.Is("(")) {
        Drop();
        *out->SetIri() = std::string(kRdfNil);
        return Expect(")", "after '('");
      }
      if (!token.Is("+") && !token.Is("-")) {
        Expected("a variable, IRI, literal or blank node");
        return false;
      }
      break;
    case TokenKind::kWord:
      if (!AtWord("true") && !AtWord("false")) {
        Expected("a variable, IRI, literal or blank node",
                 "a variable begins with '?', a name needs a prefix and ':'");
        return false;
      }
      break;
    case TokenKind::kEnd:
      Expected("a variable, IRI, literal or blank node");
      return false;
    default:
      break;
  }
  std::optional<Term> term = GroundTerm();
  if (!term) return false;
  out->Set(*std::move(term));
  return true;
}

std::optional<PatternTerm> Grammar::VarOrIri() {
  const SourceSpan span = Peek().span;
  if (Peek().kind == TokenKind::kVariable) return PatternTerm::Of(Variable{std::string(Take().text)}, span);
  std::optional<Term> iri = Iri();
  if (!iri) return std::nullopt;
  return PatternTerm::Of(*std::move(iri), span);
}

// Path ::= Sequence ('|' Sequence)*
std::optional<Path> Grammar::ParsePath() {
  Nested nested(this);
  if (!nested.ok()) return std::nullopt;
  std::optional<Path> first = PathSequence();
  if (!first || !At("|")) return first;
  Path path = PathOf(Path::Kind::kAlternative, *std::move(first));
  while (Accept("|")) {
    std::optional<Path> next = PathSequence();
    if (!next) return std::nullopt;
    path.children.push_back(*std::move(next));
  }
  return path;
}

std::optional<Path> Grammar::PathSequence() {
  std::optional<Path> first = PathEltOrInverse();
  if (!first || !At("/")) return first;
  Path path = PathOf(Path::Kind::kSequence, *std::move(first));
  while (Accept("/")) {
    std::optional<Path> next = PathEltOrInverse();
    if (!next) return std::nullopt;
    path.children.push_back(*std::move(next));
  }
  return path;
}

std::optional<Path> Grammar::PathEltOrInverse() {
  const bool inverse = Accept("^");
  std::optional<Path> path = PathPrimary();
  if (!path || !CountPathStep()) return std::nullopt;
  if (Accept("*")) {
    path = PathOf(Path::Kind::kZeroOrMore, *std::move(path));
  } else if (Accept("+")) {
    path = PathOf(Path::Kind::kOneOrMore, *std::move(path));
  } else if (Accept("?")) {
    path = PathOf(Path::Kind::kZeroOrOne, *std::move(path));
  }
  return inverse ? PathOf(Path::Kind::kInverse, *std::move(path)) : path;
}

std::optional<Path> Grammar::PathPrimary() {
  if (Accept("(")) {
    std::optional<Path> path = ParsePath();
    if (!path || !Expect(")", "to close the path")) return std::nullopt;
    return path;
  }
  if (Accept("!")) return PathNegatedSet();
  if (Peek().IsA()) {
    Take();
    return PathOf(Term::Iri(std::string(kRdfType)));
  }
  if (Peek().kind != TokenKind::kIri && Peek().kind != TokenKind::kPrefixedName) {
    Expected("a predicate", "a triple is subject, predicate, object");
    return std::nullopt;
  }
  std::optional<Term> iri = Iri();
  if (!iri) return std::nullopt;
  return PathOf(*std::move(iri));
}

std::optional<Path> Grammar::PathNegatedSet() {
  Path set;
  set.kind = Path::Kind::kNegatedSet;
  const auto one = [&]() -> bool {
    const bool inverse = Accept("^");
    std::optional<Term> iri;
    if (Peek().IsA()) {
      Take();
      iri = Term::Iri(std::string(kRdfType));
    } else {
      iri = Iri();
    }
    if (!iri || !CountPathStep()) return false;
    Path path = PathOf(*std::move(iri));
    set.children.push_back(inverse ? PathOf(Path::Kind::kInverse, std::move(path)) : std::move(path));
    return true;
  };
  if (!Accept("(")) {
    if (!one()) return std::nullopt;
    return set;
  }
  if (Accept(")")) return set;
  do {
    if (!one()) return std::nullopt;
  } while (Accept("|"));
  if (!Expect(")", "to close the negated set")) return std::nullopt;
  return set;
}

void Grammar::TranslatePath(const PatternTerm& subject, const Path& path, const PatternTerm& object,
                            TriplesSink* sink) {
  switch (path.kind) {
    case Path::Kind::kIri:
      if (!CountTriple(false)) return;
      ChargeCopy(subject);
      ChargeCopy(object);
      Charge(TextMemory(path.iri));
      sink->triples.push_back({subject, PatternTerm::Of(path.iri, subject.span), object});
      return;
    case Path::Kind::kInverse:
      TranslatePath(object, path.children[0], subject, sink);
      return;
    case Path::Kind::kSequence: {
      PatternTerm from = subject;
      for (size_t i = 0; i < path.children.size() && !ended_; ++i) {
        const bool last = i + 1 == path.children.size();
        PatternTerm to =
            last ? object : PatternTerm::Of(Variable{".p" + std::to_string(counter_++)}, subject.span);
        TranslatePath(from, path.children[i], to, sink);
        from = std::move(to);
      }
      return;
    }
    case Path::Kind::kAlternative: {
      auto all = NewAlgebra(Algebra::Kind::kUnion, subject.span);
      for (const Path& child : path.children) {
        if (!CountPattern()) return;
        TriplesSink branch;
        TranslatePath(subject, child, object, &branch);
        all->children.push_back(SinkToAlgebra(std::move(branch)));
      }
      sink->paths.push_back(std::move(all));
      return;
    }
    default: {
      auto node = NewAlgebra(Algebra::Kind::kPath, subject.span);
      if (!CountPattern() || !Charge(MemoryBytes(path))) return;
      ChargeCopy(subject);
      ChargeCopy(object);
      node->subject = subject;
      node->path = path;
      node->object = object;
      sink->paths.push_back(std::move(node));
      return;
    }
  }
}

AlgebraPtr Grammar::SinkToAlgebra(TriplesSink sink) {
  AlgebraPtr bgp;
  if (!sink.triples.empty() || sink.paths.empty()) {
    bgp = NewAlgebra(Algebra::Kind::kBgp);
    bgp->triples = std::move(sink.triples);
    if (sink.paths.empty()) return bgp;
  }
  if (!bgp && sink.paths.size() == 1) return std::move(sink.paths[0]);
  auto join = NewAlgebra(Algebra::Kind::kJoin);
  if (bgp) join->children.push_back(std::move(bgp));
  for (AlgebraPtr& path : sink.paths) join->children.push_back(std::move(path));
  return join;
}

}  // namespace docent::sparql
