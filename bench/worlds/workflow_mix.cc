#include "bench/worlds/workflow_mix.h"

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::bench {
namespace {

enum class Kind { kThreshold, kJoin, kNegated, kFree };

Kind KindOf(size_t i) {
  switch (i % 6) {
    case 0:
    case 1:
      return Kind::kThreshold;
    case 2:
    case 3:
      return Kind::kJoin;
    case 4:
      return Kind::kNegated;
    default:
      return Kind::kFree;
  }
}

std::string Ex(const std::string& local) {
  return absl::StrCat("urn:mix:", local);
}
Term Iri(const std::string& local) {
  return Term::Iri(Ex(local));
}
std::string Angle(const std::string& local) {
  return absl::StrCat("<", Ex(local), ">");
}
std::string IsAt() {
  return absl::StrCat("<", DocentIri("isAt"), ">");
}

std::string Escape(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string CawlConstraint(const std::string& name, const std::string& s, const std::string& v,
                           const std::string& o) {
  return absl::StrCat("<constraint name=\"", name, "\"><subject>", Escape(s), "</subject><verb>", Escape(v),
                      "</verb><object>", Escape(o), "</object></constraint>");
}

// Visitors of the background; each update of a round uses another visitor.
constexpr size_t kTriplesPerVisitor = 4;
size_t Visitors(size_t triples) {
  return triples / kTriplesPerVisitor;
}

}  // namespace

std::string CawlRuleNumber(size_t i) {
  std::string n = absl::StrCat(i);
  switch (KindOf(i)) {
    case Kind::kThreshold: {
      std::string threshold = absl::StrCat(20 + i % 10, ".5");
      // in CAWL the value is bound by a second constraint, so that the run knows it
      return absl::StrCat(
          "<rule name=\"r\">", CawlConstraint("a", Angle("sensor" + n), Angle("temperature"), "?t"),
          CawlConstraint("b", Angle("sensor" + n), Angle("temperature"), "> " + threshold), "</rule>");
    }
    case Kind::kJoin:
      return absl::StrCat("<rule name=\"r\">", CawlConstraint("a", "?v", IsAt(), Angle("region" + n)),
                          CawlConstraint("b", "?v", Angle("likes"), Angle("topic" + n)), "</rule>");
    case Kind::kNegated:
      return absl::StrCat("<rule name=\"r\" expression=\"a and not b\">",
                          CawlConstraint("a", "?v", IsAt(), Angle("room" + n)),
                          CawlConstraint("b", "?v", Angle("badge"), "?b"), "</rule>");
    case Kind::kFree:
      return absl::StrCat("<rule name=\"r\">", CawlConstraint("a", "?v", Angle("carries"), "?item"),
                          CawlConstraint("b", "?item", Angle("ownedBy"), Angle("owner" + n)), "</rule>");
  }
  return "";
}

std::string TokenVariable(size_t i) {
  return KindOf(i) == Kind::kThreshold ? "t" : "v";
}

std::vector<TermQuad> Background(size_t triples, size_t conditions) {
  std::vector<TermQuad> quads;
  quads.reserve(triples + conditions);
  Term type = Term::Iri(std::string(kRdfType));
  for (size_t v = 0; v < Visitors(triples); ++v) {
    Term visitor = Iri(absl::StrCat("visitor", v));
    quads.push_back({visitor, type, Term::Iri(DocentIri("Visitor")), Term()});
    quads.push_back(
        {visitor, Term::Iri(Concat(kSchemaNs, "name")), Term::Literal(absl::StrCat("Visitor ", v)), Term()});
    // joins are through the topic of "its" condition, see UpdateNumber
    quads.push_back({visitor, Iri("likes"), Iri(absl::StrCat("topic", v % conditions)), Term()});
    quads.push_back(
        {Iri(absl::StrCat("item", v)), Iri("ownedBy"), Iri(absl::StrCat("owner", v % conditions)), Term()});
  }
  return quads;
}

MixedUpdate UpdateNumber(uint64_t k, size_t conditions, size_t background_triples) {
  // a large odd step walks over all conditions without following their order
  size_t i = (k * 7919) % conditions;
  size_t round = static_cast<size_t>(k / conditions);
  size_t per_condition = Visitors(background_triples) / conditions;
  size_t v = (round % per_condition) * conditions + i;  // likes topic i, owns item v of owner i
  MixedUpdate update;
  std::string n = absl::StrCat(i);
  Term visitor = Iri(absl::StrCat("visitor", v));
  switch (KindOf(i)) {
    case Kind::kThreshold: {
      // canonical decimals that are never repeated
      std::string value = absl::StrCat(40 + k / 1000, ".", absl::Dec(k % 1000, absl::kZeroPad3), "1");
      update.add = {Iri("sensor" + n), Iri("temperature"), Term::Literal(value, std::string(kXsdDecimal)),
                    Term()};
      update.token = value;
      return update;
    }
    case Kind::kJoin:
      update.add = {visitor, Term::Iri(DocentIri("isAt")), Iri("region" + n), Term()};
      break;
    case Kind::kNegated:
      update.add = {visitor, Term::Iri(DocentIri("isAt")), Iri("room" + n), Term()};
      break;
    case Kind::kFree:
      update.add = {visitor, Iri("carries"), Iri(absl::StrCat("item", v)), Term()};
      break;
  }
  update.token = visitor.lexical;
  return update;
}

std::vector<TermQuad> StateProperties() {
  Term type = Term::Iri(std::string(kRdfType));
  Term state = Term::Iri(DocentIri("StateProperty"));
  return {{Term::Iri(DocentIri("isAt")), type, state, Term()}, {Iri("temperature"), type, state, Term()}};
}

}  // namespace docent::bench
