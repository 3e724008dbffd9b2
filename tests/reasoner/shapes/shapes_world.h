// A file of shapes and a file of data to validate.
#ifndef DOCENT_TESTS_REASONER_SHAPES_SHAPES_WORLD_H_
#define DOCENT_TESTS_REASONER_SHAPES_SHAPES_WORLD_H_

#include <string>

#include <gtest/gtest.h>

#include "reasoner/shapes/file_graph.h"
#include "reasoner/shapes/report.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/validator.h"

namespace docent::shapes {

inline constexpr char kPrefixes[] =
    "@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix : <http://e/> . @prefix xsd: "
    "<http://www.w3.org/2001/XMLSchema#> .\n"
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix owl: <http://www.w3.org/2002/07/owl#> "
    ".\n";

class ShapesTest : public testing::Test {
 protected:
  void Add(const std::string& file, const std::string& turtle) {
    ParseRdfOptions options;
    options.file = file;
    options.blank_node_scope = file + "_";
    const LocatedRdf document = ParseLocatedRdf(kPrefixes + turtle, RdfFormat::kTurtle, options);
    ASSERT_TRUE(document.rdf.ok()) << Render(document.rdf.diagnostics, turtle);
    graph_.Add(file, document, "urn:" + file);
  }
  ParsedShapes Read(const CheckLimits& limits = {}) {
    return ReadShapes(graph_.View("urn:shapes.ttl"), graph_.dictionary(), limits,
                      &graph_.Places("urn:shapes.ttl"));
  }
  std::string Mistakes(const std::string& turtle, const CheckLimits& limits = {}) {
    Add("shapes.ttl", turtle);
    return docent::Render(Read(limits).diagnostics, "");
  }
  absl::StatusOr<ValidationReport> Run(const ValidateOptions& options = {}) {
    const ParsedShapes parsed = Read();
    EXPECT_TRUE(parsed.ok()) << docent::Render(parsed.diagnostics, "");
    return Validate(parsed.shapes, graph_.View("urn:data.ttl"), graph_.dictionary(), options);
  }
  std::string Text(const ValidationReport& report) {
    std::string text;
    for (const ValidationResult& result : report.results) {
      text += Render(Describe(result, graph_.dictionary(), &graph_.Places("urn:data.ttl"),
                              &graph_.Places("urn:shapes.ttl")));
    }
    return text;
  }

  FileGraph graph_;
};

}  // namespace docent::shapes

#endif  // DOCENT_TESTS_REASONER_SHAPES_SHAPES_WORLD_H_
