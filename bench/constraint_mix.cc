#include "bench/constraint_mix.h"

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::bench {
namespace {

enum class Shape { kThreshold, kJoin, kNegated, kFree };

Shape ShapeOf(size_t i) {
  switch (i % 6) {
    case 0:
    case 1:
      return Shape::kThreshold;
    case 2:
    case 3:
      return Shape::kJoin;
    case 4:
      return Shape::kNegated;
    default:
      return Shape::kFree;
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

// Visitors of the background; each update names one that no other update of the same round names.
constexpr size_t kTriplesPerVisitor = 4;
size_t Visitors(size_t triples) {
  return triples / kTriplesPerVisitor;
}

}  // namespace

MixedConstraint ConstraintNumber(size_t i) {
  MixedConstraint out;
  std::string n = absl::StrCat(i);
  switch (ShapeOf(i)) {
    case Shape::kThreshold: {
      std::string threshold = absl::StrCat(20 + i % 10, ".5");
      out.where =
          absl::StrCat(Angle("sensor" + n), " ", Angle("temperature"), " ?t . FILTER(?t > ", threshold, ")");
      // in CAWL the value is bound by a second constraint, so that the run knows it
      out.cawl_rule = absl::StrCat(
          "<rule name=\"r\">", CawlConstraint("a", Angle("sensor" + n), Angle("temperature"), "?t"),
          CawlConstraint("b", Angle("sensor" + n), Angle("temperature"), "> " + threshold), "</rule>");
      break;
    }
    case Shape::kJoin:
      out.where = absl::StrCat("?v ", IsAt(), " ", Angle("region" + n), " . ?v ", Angle("likes"), " ",
                               Angle("topic" + n));
      out.cawl_rule =
          absl::StrCat("<rule name=\"r\">", CawlConstraint("a", "?v", IsAt(), Angle("region" + n)),
                       CawlConstraint("b", "?v", Angle("likes"), Angle("topic" + n)), "</rule>");
      break;
    case Shape::kNegated:
      out.where = absl::StrCat("?v ", IsAt(), " ", Angle("room" + n), " . FILTER NOT EXISTS { ?v ",
                               Angle("badge"), " ?b }");
      out.cawl_rule = absl::StrCat("<rule name=\"r\" expression=\"a and not b\">",
                                   CawlConstraint("a", "?v", IsAt(), Angle("room" + n)),
                                   CawlConstraint("b", "?v", Angle("badge"), "?b"), "</rule>");
      break;
    case Shape::kFree:
      out.where =
          absl::StrCat("?v ", Angle("carries"), " ?item . ?item ", Angle("ownedBy"), " ", Angle("owner" + n));
      out.cawl_rule =
          absl::StrCat("<rule name=\"r\">", CawlConstraint("a", "?v", Angle("carries"), "?item"),
                       CawlConstraint("b", "?item", Angle("ownedBy"), Angle("owner" + n)), "</rule>");
      break;
  }
  return out;
}

std::vector<TermQuad> Background(size_t triples, size_t constraints) {
  std::vector<TermQuad> quads;
  quads.reserve(triples + constraints);
  Term type = Term::Iri(std::string(kRdfType));
  for (size_t v = 0; v < Visitors(triples); ++v) {
    Term visitor = Iri(absl::StrCat("visitor", v));
    quads.push_back({visitor, type, Term::Iri(DocentIri("Visitor")), Term()});
    quads.push_back(
        {visitor, Term::Iri(Concat(kSchemaNs, "name")), Term::Literal(absl::StrCat("Visitor ", v)), Term()});
    // joins are through the topic of "its" constraint, see UpdateNumber
    quads.push_back({visitor, Iri("likes"), Iri(absl::StrCat("topic", v % constraints)), Term()});
    quads.push_back(
        {Iri(absl::StrCat("item", v)), Iri("ownedBy"), Iri(absl::StrCat("owner", v % constraints)), Term()});
  }
  return quads;
}

MixedUpdate UpdateNumber(uint64_t k, size_t constraints, size_t background_triples) {
  // a large odd step walks over all constraints without following their order
  size_t i = (k * 7919) % constraints;
  size_t round = static_cast<size_t>(k / constraints);
  size_t per_constraint = Visitors(background_triples) / constraints;
  size_t v = (round % per_constraint) * constraints + i;  // likes topic i, owns item v of owner i
  MixedUpdate update;
  std::string n = absl::StrCat(i);
  Term visitor = Iri(absl::StrCat("visitor", v));
  switch (ShapeOf(i)) {
    case Shape::kThreshold: {
      // canonical decimals that never come back
      std::string value = absl::StrCat(40 + k / 1000, ".", absl::Dec(k % 1000, absl::kZeroPad3), "1");
      update.add = {Iri("sensor" + n), Iri("temperature"), Term::Literal(value, std::string(kXsdDecimal)),
                    Term()};
      update.token = value;
      return update;
    }
    case Shape::kJoin:
      update.add = {visitor, Term::Iri(DocentIri("isAt")), Iri("region" + n), Term()};
      break;
    case Shape::kNegated:
      update.add = {visitor, Term::Iri(DocentIri("isAt")), Iri("room" + n), Term()};
      break;
    case Shape::kFree:
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
