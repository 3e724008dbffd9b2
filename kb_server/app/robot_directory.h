// Which robots the graph says offer an operation: docent:offers, docent:incarnation, docent:status.
// Reads one version; writer thread only.
#ifndef DOCENT_KB_SERVER_APP_ROBOT_DIRECTORY_H_
#define DOCENT_KB_SERVER_APP_ROBOT_DIRECTORY_H_

#include <string>
#include <vector>

#include "kb_server/rdf/dictionary.h"
#include "kb_server/store/graph_version.h"
#include "workflow/engine/ports.h"

namespace docent {

class GraphRobotDirectory final : public RobotDirectory {
 public:
  // Both must outlive the directory.
  GraphRobotDirectory(const Dictionary& dictionary, const GraphVersion& version)
      : dictionary_(dictionary), version_(version) {}

  std::vector<RobotOffer> Offers(const std::string& operation) const override;

 private:
  const Dictionary& dictionary_;
  const GraphVersion& version_;
};

// "urn:docent:operation:NAME".
std::string OperationIri(std::string_view name);

// The lexical form of the first object of (subject, predicate, ?) in term order; empty: none.
std::string OneValue(const Dictionary& dictionary, const GraphVersion& version, TermId subject,
                     std::string_view predicate);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_ROBOT_DIRECTORY_H_
