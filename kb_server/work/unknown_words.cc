#include "kb_server/work/unknown_words.h"

#include <algorithm>
#include <map>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "kb_server/work/known_prefixes.h"
#include "reasoner/rules/rule_parser.h"

namespace docent::server {
namespace {

// Up to the last '#', '/' or ':', which belongs to it.
std::string_view NamespaceOf(std::string_view iri) {
  size_t end = iri.find_last_of("#/");
  if (end == std::string_view::npos) end = iri.rfind(':');
  return iri.substr(0, end == std::string_view::npos ? 0 : end + 1);
}

bool IsPropertyType(std::string_view type) {
  return type == Concat(kRdfNs, "Property") || (type.starts_with(kOwlNs) && type.ends_with("Property"));
}

bool IsClassType(std::string_view type) {
  return type == Concat(kRdfsNs, "Class") || type == Concat(kOwlNs, "Class");
}

std::shared_ptr<const DeclaredWords> Read(const GraphVersion& version, const Dictionary& dictionary) {
  auto declared = std::make_shared<DeclaredWords>();
  const std::optional<TermId> type = dictionary.FindIri(kRdfType);
  for (const TermId graph : ModuleGraphs(version, dictionary)) {
    TermId last;
    version.ForEach({{}, {}, {}, graph}, [&](const Quad& quad) {
      if (!quad.subject.IsIri()) return true;
      if (quad.subject != last) declared->words.insert(std::string(dictionary.Lexical(quad.subject)));
      last = quad.subject;
      if (quad.predicate != type || !quad.object.IsIri()) return true;
      const std::string_view of = dictionary.Lexical(quad.object);
      const std::string space(NamespaceOf(dictionary.Lexical(quad.subject)));
      if (IsPropertyType(of)) declared->property_spaces.insert(space);
      if (IsClassType(of)) declared->class_spaces.insert(space);
      return true;
    });
  }
  return declared;
}

// The declared word that is spelt most like this one, if any is.
std::string NearestWord(const std::string& iri, const DeclaredWords& declared) {
  const std::string_view space = NamespaceOf(iri);
  std::vector<std::string> locals;
  for (const std::string& word : declared.words) {
    if (NamespaceOf(word) == space) locals.push_back(word.substr(space.size()));
  }
  std::sort(locals.begin(), locals.end());
  const std::string local = Nearest(std::string_view(iri).substr(space.size()), locals);
  return local.empty() ? "" : Concat(space, local);
}

struct Unknown {
  std::string iri;
  bool is_class;
  std::string file;  // of a rule, and its place there; empty: of a fact
  SourceSpan place;
};

// Collects the words of facts and rules that are not declared, each once.
class Finder {
 public:
  explicit Finder(const DeclaredWords& declared) : declared_(declared) {}

  void LookAt(const WriteBatch& batch) {
    for (const QuadOperation& operation : batch.operations) {
      if (operation.kind != QuadOperation::Kind::kAdd) continue;
      LookAt(operation.quad.predicate, false, "", {});
      if (operation.quad.predicate.lexical == kRdfType) LookAt(operation.quad.object, true, "", {});
    }
  }

  void LookAt(const rules::ParsedRules& rules, const std::string& file) {
    for (const rules::Rule& rule : rules.rules) {
      for (const sparql::TriplePattern& pattern : rule.head) LookAt(pattern, file);
      if (!rule.body.algebra) continue;
      sparql::AnyNode(*rule.body.algebra, [&](const sparql::Algebra& node) {
        for (const sparql::TriplePattern& pattern : node.triples) LookAt(pattern, file);
        if (node.kind == sparql::Algebra::Kind::kPath) LookAt(node.path, file, node.subject.span);
        return false;
      });
    }
  }

  std::vector<Unknown> Take() { return std::move(found_); }

 private:
  void LookAt(const Term& word, bool is_class, const std::string& file, const SourceSpan& place) {
    const auto& spaces = is_class ? declared_.class_spaces : declared_.property_spaces;
    if (!word.IsIri() || found_.size() == UnknownWords::kMost) return;
    if (!spaces.contains(ToAbsl(NamespaceOf(word.lexical))) || declared_.words.contains(word.lexical)) return;
    if (seen_.insert(word.lexical).second) found_.push_back({word.lexical, is_class, file, place});
  }

  void LookAt(const sparql::TriplePattern& pattern, const std::string& file) {
    if (pattern.predicate.IsVariable()) return;
    LookAt(pattern.predicate.term(), false, file, pattern.predicate.span);
    if (pattern.predicate.term().lexical == kRdfType && !pattern.object.IsVariable())
      LookAt(pattern.object.term(), true, file, pattern.object.span);
  }

  void LookAt(const sparql::Path& path, const std::string& file, const SourceSpan& place) {
    if (path.kind == sparql::Path::Kind::kIri) LookAt(path.iri, false, file, place);
    for (const sparql::Path& child : path.children) LookAt(child, file, place);
  }

  const DeclaredWords& declared_;
  absl::flat_hash_set<std::string> seen_;
  std::vector<Unknown> found_;
};

std::vector<Unknown> Find(const WriteBatch& batch, const DeclaredWords& declared, const ReadPorts& ports) {
  Finder finder(declared);
  finder.LookAt(batch);
  for (const Document& document : batch.documents) {
    if (document.kind != Document::Kind::kRules || document.action != Document::Action::kPut) continue;
    finder.LookAt(rules::ParseRules(document.text, document.name, ports.limits, ports.functions),
                  document.name);
  }
  return finder.Take();
}

// Where each of them stands first in the text, by its IRI.
std::map<std::string, SourceSpan> PlacesOf(const std::vector<Unknown>& unknown, const LoadedText& text) {
  std::map<std::string, SourceSpan> places;
  if (text.name.empty()) return places;
  const LocatedRdf document = text.parse();
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    const TermQuad& quad = document.rdf.quads[i];
    for (const Unknown& word : unknown) {
      if (!word.file.empty()) continue;
      const Term& term = word.is_class ? quad.object : quad.predicate;
      if (!term.IsIri() || term.lexical != word.iri) continue;
      const QuadPlace& place = document.places[i];
      places.try_emplace(word.iri, word.is_class ? place.object : place.predicate);
    }
  }
  return places;
}

}  // namespace

std::shared_ptr<const DeclaredWords> UnknownWords::Declared() {
  const std::shared_ptr<const Catalog> catalog = catalog_ == nullptr ? nullptr : catalog_->Get();
  {
    absl::MutexLock lock(&mutex_);
    if (declared_ != nullptr && catalog != nullptr && read_ == catalog) return declared_;
  }
  auto declared = Read(*ports_.queries->Newest(), *ports_.dictionary);
  absl::MutexLock lock(&mutex_);
  read_ = catalog;
  declared_ = declared;
  return declared;
}

Diagnostics UnknownWords::In(const WriteBatch& batch, const LoadedText& text) {
  const auto declared = Declared();
  const std::vector<Unknown> unknown = Find(batch, *declared, ports_);
  if (unknown.empty()) return {};
  const auto places = PlacesOf(unknown, text);
  const auto names = KnownNames(ports_);
  const IriNames& shown = names != nullptr ? *names : IriNames::WellKnown();
  Diagnostics warnings;
  for (const Unknown& word : unknown) {
    Diagnostic warning;
    warning.severity = Diagnostic::Severity::kWarning;
    if (!word.file.empty()) {
      warning.file = word.file;
      warning.span = word.place;
    } else if (const auto place = places.find(word.iri); place != places.end()) {
      warning.file = text.name;
      warning.span = place->second;
    }
    warning.message = Concat("no loaded ontology has the ", word.is_class ? "class " : "property ",
                             shown.Iri(word.iri), ", though one has others of its namespace");
    const std::string near = NearestWord(word.iri, *declared);
    warning.hint =
        near.empty() ? "declare it in the ontology" : Concat("did you mean ", shown.Iri(near), "?");
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace docent::server
