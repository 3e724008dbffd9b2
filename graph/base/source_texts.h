// Source texts by file name, for rendering diagnostics. A mistake may involve several documents (rules of two
// sets that negate each other); each diagnostic is then shown with its own source line. One thread.
#ifndef DOCENT_GRAPH_BASE_SOURCE_TEXTS_H_
#define DOCENT_GRAPH_BASE_SOURCE_TEXTS_H_

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "graph/base/diagnostic.h"

namespace docent {

class SourceTexts {
 public:
  // Adds a text, or replaces the text of that name. `text` must outlive this object.
  void Put(std::string file, std::string_view text) { texts_.insert_or_assign(std::move(file), text); }

  // As docent::Render and ToStatus. Line and caret are left out if the file is not known here.
  std::string Render(const Diagnostics& diagnostics) const {
    std::string out;
    for (const Diagnostic& d : diagnostics) {
      const auto text = texts_.find(d.file);
      out += docent::Render({d}, text == texts_.end() ? std::string_view() : text->second);
    }
    return out;
  }
  absl::Status ToStatus(const Diagnostics& diagnostics) const {
    if (!HasErrors(diagnostics)) return absl::OkStatus();
    return absl::InvalidArgumentError(Render(diagnostics));
  }

 private:
  std::map<std::string, std::string_view> texts_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_SOURCE_TEXTS_H_
