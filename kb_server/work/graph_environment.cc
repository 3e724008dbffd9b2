#include "kb_server/work/graph_environment.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/door/operation_signature.h"
#include "kb_server/robots/robot_records.h"
#include "workflow/cawl/check/subflow_names.h"

namespace docent::server {
namespace {

class LiveEnvironment final : public cawl::Environment {
 public:
  LiveEnvironment(const Dictionary& dictionary, GraphVersionPtr version,
                  std::shared_ptr<const Catalog> catalog, const sparql::FunctionRegistry* functions)
      : dictionary_(dictionary),
        version_(std::move(version)),
        catalog_(std::move(catalog)),
        functions_(functions) {}

  std::optional<cawl::OperationSignature> FindOperation(std::string_view name) const override {
    if (rsel::PlanPtr plan = catalog_->services.Find(name)) return SignatureOf(*plan);
    return SignatureFor(name);
  }
  std::vector<std::string> OperationNames() const override {
    std::vector<std::string> names = catalog_->services.ProcessNames();
    for (const rsel::OfferedOperation& offered : Offered()) names.push_back(offered.name);
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }
  std::optional<std::vector<std::string>> OfferedCapabilities() const override {
    std::set<std::string> classes;
    for (const rsel::OfferedOperation& offered : Offered())
      classes.insert(offered.capabilities.begin(), offered.capabilities.end());
    return std::vector<std::string>(classes.begin(), classes.end());
  }
  std::vector<cawl::DescribedOperation> Described() const override {
    std::vector<cawl::DescribedOperation> described;
    for (const rsel::OfferedOperation& offered : Offered())
      described.push_back({offered.name, offered.capabilities, offered.input_types});
    return described;
  }
  const sparql::FunctionRegistry* Functions() const override { return functions_; }
  std::vector<std::string> ApplicationServices() const override {
    std::vector<std::string> names;
    for (const auto& [document, revision] : catalog_->workflows) {
      for (std::string& name : cawl::SubflowNames(*document)) names.push_back(std::move(name));
    }
    return names;
  }
  bool IsClass(const std::string& iri) const override {
    const std::string below = Concat(kRdfsNs, "subClassOf");
    return HasType(iri, cawl::ClassTypes()) || Has(iri, below, {}) || Has({}, below, iri);
  }
  bool IsProperty(const std::string& iri) const override {
    const std::string below = Concat(kRdfsNs, "subPropertyOf");
    return HasType(iri, cawl::PropertyTypes()) || Has(iri, below, {}) || Has({}, below, iri);
  }
  bool IsKnown(const std::string& iri) const override {
    return Has(iri, {}, {}) || IsClass(iri) || IsProperty(iri);
  }
  std::vector<std::string> Classes(std::string_view namespace_iri) const override {
    return OfTypes(cawl::ClassTypes(), namespace_iri);
  }
  std::vector<std::string> Properties(std::string_view namespace_iri) const override {
    return OfTypes(cawl::PropertyTypes(), namespace_iri);
  }
  std::vector<std::string> Words(std::string_view namespace_iri) const override {
    std::vector<std::string> words;
    auto type = dictionary_.FindIri(kRdfType);
    if (type)
      version_->ForEach({{}, *type, {}, {}},
                        [&](const Quad& quad) { return Take(quad.subject, namespace_iri, &words); });
    return words;
  }
  std::vector<Term> Objects(const Term& subject, std::string_view predicate) const override {
    std::vector<Term> out;
    const auto s = dictionary_.Find(subject), p = dictionary_.FindIri(predicate);
    if (!s || !p) return out;
    version_->ForEach({*s, *p, {}, {}}, [&](const Quad& quad) { return Keep(quad.object, &out); });
    return out;
  }
  std::vector<Term> Subjects(std::string_view predicate, const Term& object) const override {
    std::vector<Term> out;
    const auto p = dictionary_.FindIri(predicate), o = dictionary_.Find(object);
    if (!p || !o) return out;
    version_->ForEach({{}, *p, *o, {}}, [&](const Quad& quad) { return Keep(quad.subject, &out); });
    return out;
  }

 private:
  bool Keep(TermId id, std::vector<Term>* out) const {
    out->push_back(dictionary_.Decode(id));
    return out->size() < kMaxFacts;
  }
  // The inputs that every robot takes that describes the operation; nullopt: no robot offers it.
  std::optional<cawl::OperationSignature> SignatureFor(std::string_view name) const {
    std::optional<cawl::OperationSignature> out;
    for (const rsel::OfferedOperation& offered : Offered()) {
      if (offered.name != name) continue;
      if (!out) out = cawl::OperationSignature{offered.name, {}, false, true};
      if (!offered.inputs_known) continue;
      if (!out->inputs_known) {
        out->inputs = offered.inputs;
      } else {
        std::erase_if(out->inputs, [&](const std::string& part) {
          return std::find(offered.inputs.begin(), offered.inputs.end(), part) == offered.inputs.end();
        });
      }
      out->inputs_known = true;
    }
    return out;
  }
  const std::vector<rsel::OfferedOperation>& Offered() const {
    if (!offered_) offered_ = OfferedOperations(dictionary_, *version_);
    return *offered_;
  }
  // Empty text is a wildcard.
  bool Has(const std::string& subject, const std::string& predicate, const std::string& object) const {
    QuadPattern pattern;
    for (auto [text, place] : {std::pair{&subject, &pattern.subject},
                               {&predicate, &pattern.predicate},
                               {&object, &pattern.object}}) {
      if (text->empty()) continue;
      auto id = dictionary_.FindIri(*text);
      if (!id) return false;
      *place = *id;
    }
    return version_->ContainsMatch(pattern);
  }
  bool HasType(const std::string& iri, const std::vector<std::string>& types) const {
    return std::any_of(types.begin(), types.end(),
                       [&](const std::string& type) { return Has(iri, std::string(kRdfType), type); });
  }
  bool Take(TermId id, std::string_view namespace_iri, std::vector<std::string>* words) const {
    if (!id.IsIri()) return true;
    std::string_view iri = dictionary_.Lexical(id);
    if (iri.substr(0, namespace_iri.size()) == namespace_iri) words->emplace_back(iri);
    return true;
  }
  std::vector<std::string> OfTypes(const std::vector<std::string>& types,
                                   std::string_view namespace_iri) const {
    std::vector<std::string> words;
    auto type = dictionary_.FindIri(kRdfType);
    for (const std::string& name : types) {
      auto id = dictionary_.FindIri(name);
      if (!type || !id) continue;
      version_->ForEach({{}, *type, *id, {}},
                        [&](const Quad& quad) { return Take(quad.subject, namespace_iri, &words); });
    }
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return words;
  }

  const Dictionary& dictionary_;
  const GraphVersionPtr version_;
  const std::shared_ptr<const Catalog> catalog_;
  const sparql::FunctionRegistry* const functions_;
  mutable std::optional<std::vector<rsel::OfferedOperation>> offered_;
};

}  // namespace

std::unique_ptr<cawl::Environment> GraphEnvironment(const Dictionary& dictionary, GraphVersionPtr version,
                                                    std::shared_ptr<const Catalog> catalog,
                                                    const sparql::FunctionRegistry* functions) {
  return std::make_unique<LiveEnvironment>(dictionary, std::move(version), std::move(catalog), functions);
}

}  // namespace docent::server
