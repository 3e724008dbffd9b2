#include "reasoner/shapes/path_reader.h"

#include <array>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::shapes {
namespace {

struct PathWord {
  std::string_view local;
  Path::Kind kind;
};
constexpr std::array<PathWord, 5> kPathWords = {{{"inversePath", Path::Kind::kInverse},
                                                 {"alternativePath", Path::Kind::kAlternative},
                                                 {"zeroOrMorePath", Path::Kind::kZeroOrMore},
                                                 {"oneOrMorePath", Path::Kind::kOneOrMore},
                                                 {"zeroOrOnePath", Path::Kind::kZeroOrOne}}};

TermId IdOf(const Dictionary& dictionary, std::string_view iri) {
  return dictionary.FindIri(iri).value_or(kAbsentTerm);
}

}  // namespace

PathReader::PathReader(const GraphView& graph, const Dictionary& dictionary, int nesting_limit)
    : graph_(graph),
      dictionary_(dictionary),
      nesting_limit_(nesting_limit),
      first_(IdOf(dictionary, Concat(kRdfNs, "first"))),
      rest_(IdOf(dictionary, Concat(kRdfNs, "rest"))),
      nil_(IdOf(dictionary, Concat(kRdfNs, "nil"))) {}

std::nullopt_t PathReader::Fail(std::string problem) {
  problem_ = std::move(problem);
  return std::nullopt;
}

std::optional<std::vector<TermId>> PathReader::ReadList(TermId head) {
  std::vector<TermId> members;
  absl::flat_hash_set<TermId> seen;
  for (TermId cell = head; cell != nil_;) {
    if (!seen.insert(cell).second) return Fail("the list goes in a circle");
    const std::vector<TermId> values = graph_.Objects(cell, first_), rests = graph_.Objects(cell, rest_);
    if (values.size() != 1 || rests.size() != 1) {
      return Fail(absl::StrCat(ToDisplay(dictionary_.Decode(cell)), " is not an RDF list: it has ",
                               values.size(), " rdf:first and ", rests.size(),
                               " rdf:rest where there should be one each"));
    }
    members.push_back(values[0]);
    cell = rests[0];
  }
  return members;
}

std::optional<Path> PathReader::Read(TermId node) {
  return ReadNested(node, 0);
}

std::optional<Path> PathReader::ReadMembers(Path::Kind kind, TermId list, int depth) {
  std::optional<std::vector<TermId>> members = ReadList(list);
  if (!members) return std::nullopt;
  if (members->size() < 2) {
    return Fail(absl::StrCat(kind == Path::Kind::kSequence ? "a sequence" : "an alternative",
                             " path needs at least two members, this list has ", members->size()));
  }
  Path path;
  path.kind = kind;
  for (const TermId member : *members) {
    std::optional<Path> child = ReadNested(member, depth + 1);
    if (!child) return std::nullopt;
    path.children.push_back(*std::move(child));
  }
  return path;
}

std::optional<Path> PathReader::ReadNested(TermId node, int depth) {
  if (depth > nesting_limit_) {
    return Fail(absl::StrCat("the path refers to itself, or is nested deeper than the limit shape_nesting = ",
                             nesting_limit_));
  }
  Path path;
  if (node.IsIri()) {
    path.predicate = node;
    return path;
  }
  if (!node.IsBlank()) {
    return Fail(absl::StrCat(ToDisplay(dictionary_.Decode(node)), " is not a property path"));
  }
  // A blank node that is a list is a sequence, whatever other triples it has (tests path-strange-001 and -002
  // of the suite).
  if (!graph_.Objects(node, first_).empty()) return ReadMembers(Path::Kind::kSequence, node, depth);
  std::optional<std::pair<Path::Kind, TermId>> found;
  for (const PathWord& word : kPathWords) {
    for (const TermId value : graph_.Objects(node, IdOf(dictionary_, Shacl(word.local)))) {
      if (found)
        return Fail("a path says more than one of sh:inversePath, sh:alternativePath, sh:zeroOrMorePath …");
      found = {word.kind, value};
    }
  }
  if (!found) {
    return Fail(
        "a blank node that is a path needs one of sh:inversePath, sh:alternativePath, sh:zeroOrMorePath, "
        "sh:oneOrMorePath, sh:zeroOrOnePath, or is a list");
  }
  if (found->first == Path::Kind::kAlternative) return ReadMembers(found->first, found->second, depth);
  std::optional<Path> child = ReadNested(found->second, depth + 1);
  if (!child) return std::nullopt;
  path.kind = found->first;
  path.children.push_back(*std::move(child));
  return path;
}

}  // namespace docent::shapes
