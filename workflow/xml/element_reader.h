// Reader base of CAWL and RSEL: checks attributes and children against what the language knows, each mistake
// reported with its place and the nearest known word. One reader a document; one thread.
#ifndef DOCENT_WORKFLOW_XML_ELEMENT_READER_H_
#define DOCENT_WORKFLOW_XML_ELEMENT_READER_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"
#include "workflow/xml/scanner.h"
#include "workflow/xml/term_text.h"
#include "workflow/xml/xml_document.h"

namespace docent::xml {

// What to do about a mistake: a sentence, and where it is one wrong word, the right one.
struct Advice {
  Advice(std::string text) : hint(std::move(text)) {}
  Advice(const char* text) : hint(text) {}
  Advice(std::string text, std::string_view wrong_word, std::string right_word)
      : hint(std::move(text)), wrong(wrong_word), right(std::move(right_word)) {}

  std::string hint;
  std::string wrong, right;  // empty: none
};

class ElementReader {
 public:
  // Errors of one document, and as many warnings; what follows is counted only.
  static constexpr size_t kMaxDiagnostics = 200;

  // `extension_ns` is the namespace of the language's extension attributes. `root` (null: no elements are read) is the
  // document. What is given must outlive the reader.
  ElementReader(std::string_view source, const std::string& file, std::string_view extension_ns,
                const Element* root = nullptr)
      : source_(source), lines_(source), file_(file), extension_ns_(extension_ns), root_(root) {}

  // Each gives the report, to which the name of its rule and another fix may be added. Where the advice has words, and the
  // wrong one stands once in the span, the fix is to put the right one there.
  Diagnostic& Error(const SourceSpan& span, std::string message, const Advice& advice = "");
  Diagnostic& Warning(const SourceSpan& span, std::string message, const Advice& advice = "");
  // So many reports of this kind that no further one will be shown: what costs time for a message may be left out.
  bool full(Diagnostic::Severity severity) const { return CountOf(severity).kept >= kMaxDiagnostics; }
  // "did you mean X?" with the nearest of `known`, or `otherwise` where none is near.
  Advice DidYouMean(std::string_view word, const std::vector<std::string>& known,
                    std::string otherwise) const;
  // All reports so far in order of the text, and last how many errors and warnings are left out.
  Diagnostics TakeDiagnostics();

  // Reports each attribute that is neither in `known`, nor an extension in `extensions`, nor of a foreign namespace
  // (an editor's own; kept in the text, not looked at). Also attributes that stand twice.
  void CheckAttributes(const Element& element, const std::vector<std::string>& known,
                       const std::vector<std::string>& extensions = {});
  // An element of a namespace that is neither the root element's, nor one of Docent's: an editor's own. It is kept in the
  // text, and nothing in it is looked at.
  bool IsForeign(const Element& element) const {
    return root_ != nullptr && IsForeign(element, root_->namespace_iri);
  }
  static bool IsForeign(const Element& element, std::string_view own_ns);
  // Reports `child` as unknown in its parent. `known` are the names that may stand there.
  void UnknownChild(const Element& parent, const Element& child, const std::vector<std::string>& known);

  // Calls the function of each child's name. An unknown child is reported; <documentation> and foreign elements may stand
  // anywhere; text beside the children is reported.
  using ChildTable = std::vector<std::pair<std::string_view, std::function<void(const Element&)>>>;
  void ReadChildren(const Element& element, const ChildTable& table);

  // The attribute, trimmed; not given() when absent. Required: absent or blank is an error.
  Text Attribute(const Element& element, std::string_view name) const;
  Text Required(const Element& element, std::string_view name);
  // The same for what is a name: an error, too, where it is longer than the limit name_bytes or holds control characters.
  // Anything else may stand in a name.
  Text Name(const Element& element, std::string_view attribute);
  Text OptionalName(const Element& element, std::string_view attribute);
  Text Extension(const Element& element, std::string_view name) const;
  // ext:NAME, a duration, as milliseconds; ext:timeout; ext:retry (0..100); ext:NAME="true|false"; malformed is an error.
  std::optional<int64_t> Duration(const Element& element, std::string_view name);
  std::optional<int64_t> Timeout(const Element& element) { return Duration(element, "timeout"); }
  int Retry(const Element& element);
  bool Flag(const Element& element, std::string_view name);

  // The RDF term in `text`, an attribute's value; malformed is an error at its place.
  std::optional<Term> TermOf(const Element& element, const Text& text);

  // The edit that takes an element away, with the line that it stands on by itself.
  TextEdit Removal(const SourceSpan& element) const;
  // Likewise an attribute, of which `value` is the value.
  TextEdit AttributeRemoval(const SourceSpan& value) const;

  // The span of bytes of the source.
  SourceSpan Span(size_t offset, size_t length) const { return lines_.Span(offset, length); }
  // The span of bytes [offset, offset+length) of an attribute's value; all of it where it holds references.
  SourceSpan Within(const Text& text, size_t offset, size_t length) const;

  const Element* root() const { return root_; }
  std::string_view source() const { return source_; }
  const std::string& file() const { return file_; }

 private:
  Text Trimmed(const Text& text) const;
  void CheckName(std::string_view attribute, const Text& name);
  Diagnostic& Add(Diagnostic::Severity severity, const SourceSpan& span, std::string message,
                  const Advice& advice);
  void UnknownAttribute(const Element& element, const xml::Attribute& attribute,
                        const std::vector<std::string>& known, const std::vector<std::string>& extensions);
  // A prefix of the extensions that is declared where `element` stands; empty: there is none.
  std::string ExtensionPrefix(const Element& element) const;
  // The edit that declares `prefix` for the extensions on the root element.
  TextEdit ExtensionDeclaration(std::string_view prefix) const;

  std::string_view source_;
  LineIndex lines_;
  std::string file_;
  std::string_view extension_ns_;
  const Element* root_;
  Diagnostics diagnostics_;
  Diagnostic dropped_;  // what is not kept is written here
  struct Counts {
    size_t kept = 0, left_out = 0;
  };
  const Counts& CountOf(Diagnostic::Severity severity) const {
    return severity == Diagnostic::Severity::kError ? errors_ : warnings_;
  }
  Counts errors_, warnings_;
};

// The text as it stands in an attribute's value or between tags.
std::string XmlEscaped(std::string_view text);

// "a, b and c".
std::string ListOf(const std::vector<std::string>& words);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_ELEMENT_READER_H_
