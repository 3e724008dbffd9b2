#include "kb_server/work/known_prefixes.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/prefix_places.h"

namespace docent::server {
namespace {

bool IsWellKnown(const std::pair<std::string, std::string>& prefix) {
  return std::any_of(kWellKnownPrefixes.begin(), kWellKnownPrefixes.end(), [&](const auto& known) {
    return known.first == prefix.first && known.second == prefix.second;
  });
}

bool Fits(const std::pair<std::string, std::string>& prefix, const PrefixLimits& limits) {
  return prefix.first.size() + prefix.second.size() <= limits.prefix_bytes;
}

std::shared_ptr<const IriNames> Read(const Catalog& catalog, const PrefixLimits& limits) {
  auto names = std::make_shared<IriNames>(IriNames::WellKnown());
  const auto add = [&](const std::pair<std::string, std::string>& prefix) {
    if (names->prefixes().size() < limits.known_prefixes && Fits(prefix, limits))
      names->Add(prefix.first, prefix.second);
  };
  for (const ModuleEntry& module : catalog.modules) {
    if (module.text == nullptr || module.kind != Document::Kind::kOntology) continue;
    for (const auto& prefix : ParseRdf(*module.text, RdfFormat::kTurtle).prefixes) add(prefix);
  }
  for (const ModuleEntry& module : catalog.modules) {
    if (module.text == nullptr || module.kind != Document::Kind::kRules) continue;
    for (const PrefixPlace& place : sparql::PrefixPlaces(*module.text)) add({place.prefix, place.iri});
  }
  for (const auto& [document, revision] : catalog.workflows) {
    for (const auto& prefix : document->prefixes) add(prefix);
  }
  return names;
}

}  // namespace

std::string DeclarePrefixes(const std::vector<std::pair<std::string, std::string>>& prefixes,
                            const PrefixLimits& limits) {
  IriNames names;
  for (const auto& prefix : prefixes) {
    if (names.prefixes().size() == limits.module_prefixes) break;
    if (!IsWellKnown(prefix) && Fits(prefix, limits)) names.Add(prefix.first, prefix.second);
  }
  std::string text;
  for (const auto& [prefix, name_space] : names.prefixes())
    text += Concat("@prefix ", prefix, ": ", ToNTriples(Term::Iri(name_space)), " .\n");
  return text;
}

std::shared_ptr<const IriNames> KnownPrefixes::Get() {
  const std::shared_ptr<const Catalog> catalog = catalog_.Get();
  {
    absl::MutexLock lock(&mutex_);
    if (read_ == catalog) return names_;
  }
  auto names = Read(*catalog, limits_);
  absl::MutexLock lock(&mutex_);
  read_ = catalog;
  names_ = names;
  return names;
}

std::shared_ptr<const IriNames> KnownNames(const ReadPorts& ports) {
  return ports.prefixes == nullptr ? nullptr : ports.prefixes->Get();
}

}  // namespace docent::server
