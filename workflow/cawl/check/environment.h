// Environment of a CAWL check, beyond the document's own text: the known operations, the application
// services, and the words of the ontology. The server answers from the live graph, `docent check` from files.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::cawl {

// An RSEL process or an operation that a robot offers.
struct OperationSignature {
  std::string name;
  std::vector<std::string> inputs;  // part names
  bool inputs_known = true;         // false: `inputs` says nothing
  bool of_robot = false;            // an operation that robots describe now; others may come
  // Of an RSEL process:
  std::map<std::string, std::string> input_types =
      {};                                 // part → IRI of its class or datatype, where it is told
  std::vector<std::string> outputs = {};  // names of its results
  struct Step {
    std::string operation;
    int64_t timeout_ms = 0;
  };
  std::optional<Step> longest_step = {};  // of those with a timeout, the one with the longest
};

// An operation as a robot describes it.
struct DescribedOperation {
  std::string name;
  std::vector<std::string> capabilities;           // IRIs of the classes that it is of
  std::map<std::string, std::string> input_types;  // part → IRI of its class or datatype, where it is told
};

// Must not change while a check reads it.
class Environment {
 public:
  virtual ~Environment() = default;
  virtual std::optional<OperationSignature> FindOperation(std::string_view name) const = 0;
  virtual std::vector<std::string> OperationNames() const = 0;
  // False: nothing is known of operations and flows of other documents, and a name that is not found is no finding.
  virtual bool KnowsServices() const { return true; }
  // IRIs of the classes of operations that robots describe now; nullopt: it is not known which robots there are.
  virtual std::optional<std::vector<std::string>> OfferedCapabilities() const { return std::nullopt; }
  // What robots describe now, once for each robot.
  virtual std::vector<DescribedOperation> Described() const { return {}; }
  // Functions of queries beside those of SPARQL itself; null: it is not known which there are.
  virtual const sparql::FunctionRegistry* Functions() const { return nullptr; }
  // Flows of other documents that `subflow` may name.
  virtual std::vector<std::string> ApplicationServices() const = 0;
  // IRIs of classes, of properties, and of other named things that the ontologies describe.
  virtual bool IsClass(const std::string& iri) const = 0;
  virtual bool IsProperty(const std::string& iri) const = 0;
  virtual bool IsKnown(const std::string& iri) const = 0;
  // The classes (or properties) that begin with `namespace_iri`; none: the namespace is not described at all, and
  // its words are not checked.
  virtual std::vector<std::string> Classes(std::string_view namespace_iri) const = 0;
  virtual std::vector<std::string> Properties(std::string_view namespace_iri) const = 0;
  // Everything known that begins with `namespace_iri`.
  virtual std::vector<std::string> Words(std::string_view namespace_iri) const = 0;
  // Facts of the ontologies: the objects of (subject, predicate), the subjects of (predicate, object). At most kMaxFacts.
  static constexpr size_t kMaxFacts = 1000;
  virtual std::vector<Term> Objects(const Term& subject, std::string_view predicate) const = 0;
  virtual std::vector<Term> Subjects(std::string_view predicate, const Term& object) const = 0;
};

// What says that a thing is a class or a property: the types. Every environment goes by them.
const std::vector<std::string>& ClassTypes();
const std::vector<std::string>& PropertyTypes();

// An environment of quads (ontology files, or the server's ontology graphs) and lists. Filled first, then read.
class QuadEnvironment final : public Environment {
 public:
  // Classes are what is typed rdfs:Class or owl:Class or stands in rdfs:subClassOf; properties likewise.
  void AddOntology(const std::vector<TermQuad>& quads);
  void AddOperation(OperationSignature operation);
  void AddApplicationService(std::string name);
  // A class of which a robot offers an operation.
  void AddCapability(std::string iri);
  void AddDescribed(DescribedOperation operation) { described_.push_back(std::move(operation)); }
  // They must outlive the environment.
  void SetFunctions(const sparql::FunctionRegistry* functions) { functions_ = functions; }
  void SetKnowsServices(bool knows) { knows_services_ = knows; }
  // Whether one of the ontologies declares a class or a property.
  bool HasWords() const { return !classes_.empty() || !properties_.empty(); }

  std::optional<OperationSignature> FindOperation(std::string_view name) const override;
  std::vector<std::string> OperationNames() const override;
  bool KnowsServices() const override { return knows_services_; }
  std::optional<std::vector<std::string>> OfferedCapabilities() const override { return capabilities_; }
  std::vector<DescribedOperation> Described() const override { return described_; }
  const sparql::FunctionRegistry* Functions() const override { return functions_; }
  std::vector<std::string> ApplicationServices() const override;
  bool IsClass(const std::string& iri) const override;
  bool IsProperty(const std::string& iri) const override;
  bool IsKnown(const std::string& iri) const override;
  std::vector<std::string> Classes(std::string_view namespace_iri) const override;
  std::vector<std::string> Properties(std::string_view namespace_iri) const override;
  std::vector<std::string> Words(std::string_view namespace_iri) const override;
  std::vector<Term> Objects(const Term& subject, std::string_view predicate) const override;
  std::vector<Term> Subjects(std::string_view predicate, const Term& object) const override;

 private:
  using Facts = std::map<std::pair<Term, std::string>, std::vector<Term>>;  // by a term and a predicate

  std::map<std::string, OperationSignature, std::less<>> operations_;
  std::set<std::string> services_;
  std::optional<std::vector<std::string>> capabilities_;
  std::vector<DescribedOperation> described_;
  std::set<std::string, std::less<>> classes_;
  std::set<std::string, std::less<>> properties_;
  std::set<std::string, std::less<>> known_;
  Facts objects_, subjects_;
  const sparql::FunctionRegistry* functions_ = nullptr;
  bool knows_services_ = true;
};

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_H_
