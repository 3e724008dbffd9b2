// Quads of a small hall, built in C++, so that tests of maps and robots need no RDF parser.
#ifndef DOCENT_TESTS_MAPS_LAYOUT_QUADS_H_
#define DOCENT_TESTS_MAPS_LAYOUT_QUADS_H_

#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent::maps {

class LayoutQuads {
 public:
  static std::string Iri(const std::string& local) { return "https://example.org/hall#" + local; }

  LayoutQuads& Add(Term subject, const std::string& predicate, Term object) {
    quads_.push_back({std::move(subject), Term::Iri(predicate), std::move(object), Term::Iri("")});
    return *this;
  }
  LayoutQuads& Thing(const std::string& local, const std::string& docent_class, const std::string& wkt) {
    const Term subject = Term::Iri(Iri(local)), geometry = Term::Blank("g" + std::to_string(++blanks_));
    Add(subject, std::string(kRdfType), Term::Iri(DocentIri(docent_class)));
    Add(subject, Concat(kGeoNs, "hasGeometry"), geometry);
    return Add(geometry, Concat(kGeoNs, "asWKT"), Term::Literal(wkt, Concat(kGeoNs, "wktLiteral")));
  }
  LayoutQuads& Number(const std::string& local, const std::string& property, const std::string& value) {
    return Add(Term::Iri(Iri(local)), DocentIri(property), Term::Literal(value, std::string(kXsdDecimal)));
  }
  LayoutQuads& Name(const std::string& local, const std::string& name) {
    return Add(Term::Iri(Iri(local)), Concat(kSchemaNs, "name"), Term::Literal(name));
  }
  LayoutQuads& ServicePoint(const std::string& local, const std::string& point, const std::string& heading) {
    const Term blank = Term::Blank("s" + std::to_string(++blanks_));
    Add(Term::Iri(Iri(local)), DocentIri("servicePoint"), blank);
    Add(blank, Concat(kGeoNs, "asWKT"), Term::Literal(point, Concat(kGeoNs, "wktLiteral")));
    if (heading.empty()) return *this;
    return Add(blank, DocentIri("heading"), Term::Literal(heading, std::string(kXsdDecimal)));
  }
  const std::vector<TermQuad>& quads() const { return quads_; }

  // 12 x 8 m, not symmetric: a partition, a counter, a pillar, a booth of three walls.
  static LayoutQuads SmallHall() {
    LayoutQuads q;
    q.Thing("Hall", "Hall", "POLYGON((0 0, 12 0, 12 8, 0 8, 0 0))").Number("Hall", "height", "3");
    q.Thing("Partition", "Wall", "POLYGON((4 0, 4.1 0, 4.1 3, 4 3, 4 0))")
        .Number("Partition", "height", "2.5");
    q.Thing("Desk", "Counter", "POLYGON((7 6, 9 6, 9 6.6, 7 6.6, 7 6))").Number("Desk", "height", "1.0");
    q.Thing("Step", "Obstacle", "POLYGON((1 6, 2 6, 2 7, 1 7, 1 6))").Number("Step", "height", "0.15");
    q.Thing("P1", "Pillar", "POINT(6 4)").Number("P1", "radius", "0.3").Number("P1", "height", "3");
    q.Thing("B1Back", "BoothWall", "POLYGON((9 0.5, 11.5 0.5, 11.5 0.6, 9 0.6, 9 0.5))")
        .Number("B1Back", "height", "2.4");
    q.Thing("B1Side", "BoothWall", "POLYGON((11.4 0.6, 11.5 0.6, 11.5 3, 11.4 3, 11.4 0.6))");
    q.Thing("B1", "Booth", "POLYGON((9 0.5, 11.5 0.5, 11.5 3, 9 3, 9 0.5))").Name("B1", "First booth");
    q.ServicePoint("B1", "POINT(10 2.2)", "-1.571");
    q.Thing("East", "Region", "POLYGON((8 0, 12 0, 12 8, 8 8, 8 0))").Name("East", "East side");
    return q;
  }

 private:
  std::vector<TermQuad> quads_;
  int blanks_ = 0;
};

}  // namespace docent::maps

#endif  // DOCENT_TESTS_MAPS_LAYOUT_QUADS_H_
