#include "graph/store/reading_mapper.h"

#include <algorithm>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

// The mappings of one graph version.
class Mapper {
 public:
  Mapper(const Dictionary& dictionary, const GraphVersion& version)
      : dictionary_(dictionary), version_(version) {}

  // In term order: ids are assigned in another order after a restart.
  std::vector<TermId> MappingsOf(const std::string& sensor) const {
    std::vector<TermId> mappings;
    auto predicate = dictionary_.FindIri(DocentIri("forSensor"));
    auto id = dictionary_.FindIri(sensor);
    if (!predicate || !id) return mappings;
    version_.ForEach({{}, *predicate, *id, {}}, [&mappings](const Quad& quad) {
      if (mappings.empty() || mappings.back() != quad.subject) mappings.push_back(quad.subject);
      return true;
    });
    SortByTerm(&mappings);
    return mappings;
  }

  std::vector<TermId> Objects(TermId subject, std::string_view local) const {
    std::vector<TermId> objects;
    auto predicate = dictionary_.FindIri(DocentIri(local));
    if (!predicate) return objects;
    version_.ForEach({subject, *predicate, {}, {}}, [&objects](const Quad& quad) {
      objects.push_back(quad.object);
      return true;
    });
    SortByTerm(&objects);
    return objects;
  }

  void SortByTerm(std::vector<TermId>* ids) const {
    if (ids->size() < 2) return;
    std::sort(ids->begin(), ids->end(),
              [this](TermId a, TermId b) { return dictionary_.Decode(a) < dictionary_.Decode(b); });
  }

  // Equal as RDF terms, or equal as text: a sensor may report "17" and the mapping say 17.
  bool SameValue(TermId id, const Term& value) const {
    Term term = dictionary_.Decode(id);
    return term == value || (term.IsLiteral() && value.IsLiteral() && term.lexical == value.lexical);
  }

  Term Meaning(TermId mapping, const Term& value) const {
    for (TermId entry : Objects(mapping, "valueMeaning")) {
      for (TermId raw : Objects(entry, "readingValue")) {
        if (!SameValue(raw, value)) continue;
        std::vector<TermId> means = Objects(entry, "means");
        if (!means.empty()) return dictionary_.Decode(means.front());
      }
    }
    return value;
  }

  std::optional<Term> Part(TermId mapping, std::string_view local, const Term& meaning) const {
    std::vector<TermId> parts = Objects(mapping, local);
    if (parts.empty()) return std::nullopt;
    Term part = dictionary_.Decode(parts.front());
    return part == Term::Iri(DocentIri("readingValue")) ? meaning : part;
  }

  // nullopt if whenValue excludes the value.
  absl::StatusOr<std::optional<QuadOperation>> Apply(TermId mapping, const SensorReading& reading) const {
    std::vector<TermId> when = Objects(mapping, "whenValue");
    if (!when.empty() && !SameValue(when.front(), reading.value)) return std::nullopt;
    Term meaning = Meaning(mapping, reading.value);
    std::optional<Term> subject = Part(mapping, "subject", meaning);
    std::optional<Term> predicate = Part(mapping, "predicate", meaning);
    std::optional<Term> object = Part(mapping, "object", meaning);
    std::string name = ToNTriples(dictionary_.Decode(mapping));
    if (!subject || !predicate || !object) {
      return absl::InvalidArgumentError(
          absl::StrCat("the mapping ", name, " lacks docent:subject, docent:predicate or docent:object"));
    }
    if (subject->IsLiteral() || !predicate->IsIri()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "the value ", ToNTriples(reading.value), " makes no fact by the mapping ", name, ": ",
          ToNTriples(*subject), " ", ToNTriples(*predicate), "; declare its docent:valueMeaning"));
    }
    std::vector<TermId> effect = Objects(mapping, "effect");
    bool withdraws =
        !effect.empty() && dictionary_.Decode(effect.front()) == Term::Iri(DocentIri("Withdraws"));
    QuadOperation operation;
    operation.kind = withdraws ? QuadOperation::Kind::kRemove : QuadOperation::Kind::kAdd;
    operation.quad = {*subject, *predicate, *object, Term()};
    return operation;
  }

 private:
  const Dictionary& dictionary_;
  const GraphVersion& version_;
};

}  // namespace

absl::StatusOr<std::vector<QuadOperation>> MapReadings(const std::vector<SensorReading>& readings,
                                                       const Dictionary& dictionary,
                                                       const GraphVersion& version) {
  std::vector<QuadOperation> operations;
  Mapper mapper(dictionary, version);
  for (size_t i = 0; i < readings.size(); ++i) {
    std::vector<TermId> mappings = mapper.MappingsOf(readings[i].sensor);
    if (mappings.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "readings[", i, "]: no docent:ReadingMapping is for the sensor <", readings[i].sensor, ">"));
    }
    for (TermId mapping : mappings) {
      auto operation = mapper.Apply(mapping, readings[i]);
      if (!operation.ok()) {
        return absl::Status(operation.status().code(),
                            absl::StrCat("readings[", i, "]: ", operation.status().message()));
      }
      if (*operation) operations.push_back(**std::move(operation));
    }
  }
  return operations;
}

}  // namespace docent
