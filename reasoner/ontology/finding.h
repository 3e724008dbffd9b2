// A finding of a check of documents. Values; any thread.
#ifndef DOCENT_REASONER_ONTOLOGY_FINDING_H_
#define DOCENT_REASONER_ONTOLOGY_FINDING_H_

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"

namespace docent::ontology {

struct Finding {
  std::string rule;  // a stable name: "undefined-term", "unused-prefix" …
  Diagnostic diagnostic;
  std::string proof;  // of an inconsistency: its proof, as `docent why` shows it; empty: none
};

// Findings of one file, at most `limit`, and one error more where the others are warnings; the rest are counted.
class Findings {
 public:
  Findings(std::string file, size_t limit) : file_(std::move(file)), limit_(limit) {}

  void Error(const std::string& rule, const SourceSpan& span, std::string message, std::string hint) {
    Add(rule, span, std::move(message), std::move(hint), Diagnostic::Severity::kError);
  }
  void Warning(const std::string& rule, const SourceSpan& span, std::string message, std::string hint) {
    Add(rule, span, std::move(message), std::move(hint), Diagnostic::Severity::kWarning);
  }
  void Add(Finding finding) {
    const bool is_error = finding.diagnostic.severity == Diagnostic::Severity::kError;
    if (findings_.size() >= limit_ && (!is_error || has_error_)) {
      ++left_out_;
      return;
    }
    has_error_ = has_error_ || is_error;
    findings_.push_back(std::move(finding));
  }
  // The first finding for which `test` holds; null: none.
  template <typename Test>
  Finding* Find(const Test& suits) {
    const auto found = std::find_if(findings_.begin(), findings_.end(), suits);
    return found == findings_.end() ? nullptr : &*found;
  }
  // In text order.
  std::vector<Finding> Take();
  size_t left_out() const { return left_out_; }

 private:
  void Add(const std::string& rule, const SourceSpan& span, std::string message, std::string hint,
           Diagnostic::Severity severity) {
    Add({rule, {file_, span, std::move(message), std::move(hint), severity}, ""});
  }

  const std::string file_;
  const size_t limit_;
  size_t left_out_ = 0;
  bool has_error_ = false;
  std::vector<Finding> findings_;
};

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_FINDING_H_
