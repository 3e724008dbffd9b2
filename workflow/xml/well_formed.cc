#include "workflow/xml/well_formed.h"

#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/xmlerror.h>

#include <climits>
#include <memory>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::xml {
namespace {

constexpr size_t kMaxXmlDiagnostics = 5;  // after the first, libxml2's complaints are mostly consequences
// libxml2 2.9 compares each attribute of an element with every other, and looks up prefixes one by one.
constexpr size_t kMaxAttributes = 256;   // of one element
constexpr size_t kMaxNamespaces = 1000;  // declared in one document

struct ContextDeleter {
  void operator()(xmlParserCtxtPtr context) const { xmlFreeParserCtxt(context); }
};
using ContextPtr = std::unique_ptr<xmlParserCtxt, ContextDeleter>;

// What the SAX callbacks share. libxml2 hands it back as the parser context's `_private`.
struct Run {
  std::string_view text;
  const std::string* file;
  int max_nesting;
  size_t max_elements;
  int depth = 0;
  size_t elements = 0;
  size_t namespaces = 0;
  bool stopped = false;
  Diagnostics diagnostics;
};

Run* RunOf(void* context) {
  return static_cast<Run*>(static_cast<xmlParserCtxtPtr>(context)->_private);
}

size_t OffsetOf(void* context) {
  auto* parser = static_cast<xmlParserCtxtPtr>(context);
  if (parser->input == nullptr || parser->input->cur == nullptr) return 0;
  size_t in_buffer = static_cast<size_t>(parser->input->cur - parser->input->base);
  return std::min(parser->input->consumed + in_buffer, RunOf(context)->text.size());
}

void Stop(void* context, Diagnostic diagnostic) {
  Run* run = RunOf(context);
  if (!run->stopped) run->diagnostics.push_back(std::move(diagnostic));
  run->stopped = true;
  xmlStopParser(static_cast<xmlParserCtxtPtr>(context));
}

void OnDocumentType(void* context, const xmlChar* name, const xmlChar*, const xmlChar*) {
  Run* run = RunOf(context);
  size_t at = run->text.rfind("<!DOCTYPE", OffsetOf(context));
  if (at == std::string_view::npos) at = OffsetOf(context);
  Stop(context, {*run->file, SpanAt(run->text, at, 9),
                 absl::StrCat("a document type definition is not accepted (<!DOCTYPE ",
                              name != nullptr ? reinterpret_cast<const char*>(name) : "", ">)"),
                 "remove it; entities are not expanded and nothing is loaded from elsewhere"});
}

void OnStart(void* context, const xmlChar* name, const xmlChar*, const xmlChar*, int namespaces,
             const xmlChar**, int, int, const xmlChar**) {
  Run* run = RunOf(context);
  bool too_deep = ++run->depth > run->max_nesting;
  bool too_many = ++run->elements > run->max_elements;
  run->namespaces += static_cast<size_t>(namespaces);
  bool many_namespaces = run->namespaces > kMaxNamespaces;
  if (!too_deep && !too_many && !many_namespaces) return;
  size_t at = run->text.rfind('<', OffsetOf(context));
  SourceSpan span = SpanAt(run->text, at == std::string_view::npos ? 0 : at);
  std::string_view element = reinterpret_cast<const char*>(name);
  Stop(context, {*run->file, span,
                 too_deep   ? absl::StrCat("<", ToAbsl(element),
                                           "> is nested deeper than the limit xml_nesting = ", run->max_nesting)
                 : too_many ? absl::StrCat("more elements than the limit xml_elements = ", run->max_elements)
                            : absl::StrCat("more namespace declarations than ", kMaxNamespaces),
                 ""});
}

void OnEnd(void* context, const xmlChar*, const xmlChar*, const xmlChar*) {
  --RunOf(context)->depth;
}

void OnError(void* context, xmlErrorPtr error) {
  Run* run = RunOf(context);
  // A prefix without declaration: names are compared without prefixes.
  if (run->stopped || error->code == XML_NS_ERR_UNDEFINED_NAMESPACE || error->level < XML_ERR_ERROR) return;
  if (run->diagnostics.size() >= kMaxXmlDiagnostics) return;
  SourceSpan span = SpanAt(run->text, OffsetOf(context));
  for (const Diagnostic& d : run->diagnostics) {
    if (d.span.offset == span.offset) return;  // a consequence
  }
  std::string message(
      absl::StripAsciiWhitespace(error->message != nullptr ? error->message : "malformed XML"));
  std::string hint;
  if (error->code == XML_ERR_UNDECLARED_ENTITY) {
    hint = "only &lt; &gt; &amp; &quot; &apos; and character references such as &#233; are known";
  } else if (error->code == XML_ERR_LT_IN_ATTRIBUTE) {
    hint = "write &lt; for <";
  }
  run->diagnostics.push_back({*run->file, span, "XML: " + message, hint});
}

// UTF-8 or its subset; anything else would make byte offsets lie.
bool EncodingIsUtf8(std::string_view name) {
  return absl::EqualsIgnoreCase(ToAbsl(name), "utf-8") || absl::EqualsIgnoreCase(ToAbsl(name), "utf8") ||
         absl::EqualsIgnoreCase(ToAbsl(name), "us-ascii") || absl::EqualsIgnoreCase(ToAbsl(name), "ascii");
}

// The encoding of an XML declaration as written: <?xml version="1.0" encoding="UTF-8"?>
std::string_view DeclaredEncoding(std::string_view text) {
  if (!text.starts_with("<?xml")) return {};
  std::string_view declaration = text.substr(0, text.find("?>"));
  size_t at = declaration.find("encoding");
  if (at == std::string_view::npos) return {};
  size_t open = declaration.find_first_of("\"'", at);
  if (open == std::string_view::npos) return {};
  size_t close = declaration.find(declaration[open], open + 1);
  if (close == std::string_view::npos) return {};
  return declaration.substr(open + 1, close - open - 1);
}

// The end of what opens at `at` with `open` and ends with `close`; the end of the text if it does not end.
size_t PastMarkup(std::string_view text, size_t at, std::string_view open, std::string_view close) {
  size_t end = text.find(close, at + open.size());
  return end == std::string_view::npos ? text.size() : end + close.size();
}

// The offset of the first start tag with more than kMaxAttributes attributes; npos if there is none. Exact up to the
// first place that is not well-formed, where libxml2 ends.
size_t OverfullTag(std::string_view text) {
  for (size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = PastMarkup(text, at, "<!--", "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      at = PastMarkup(text, at, "<![CDATA[", "]]>");
    } else if (rest.starts_with("<?")) {
      at = PastMarkup(text, at, "<?", "?>");
    } else {
      size_t start = at, attributes = 0;
      char quote = 0;
      for (++at; at < text.size() && (quote != 0 || text[at] != '>'); ++at) {
        if (quote != 0) {
          if (text[at] == quote) quote = 0;
        } else if (text[at] == '"' || text[at] == '\'') {
          quote = text[at];
          if (++attributes > kMaxAttributes) return start;
        }
      }
    }
  }
  return std::string_view::npos;
}

}  // namespace

Diagnostics CheckWellFormed(std::string_view text, const std::string& file, const Limits& limits) {
  if (text.size() > static_cast<size_t>(INT_MAX)) {
    return {{file,
             {},
             absl::StrCat("the document has ", text.size(), " bytes; XML is read up to ", INT_MAX),
             ""}};
  }
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return {{file, SpanAt(text, 0), "the document is UTF-16; only UTF-8 is accepted", "save it as UTF-8"}};
  }
  std::string_view encoding = DeclaredEncoding(text);
  if (!encoding.empty() && !EncodingIsUtf8(encoding)) {
    return {{file, SpanAt(text, encoding.data() - text.data(), encoding.size()),
             absl::StrCat("encoding \"", ToAbsl(encoding), "\" is not accepted"),
             "save the document as UTF-8"}};
  }
  if (size_t at = OverfullTag(text); at != std::string_view::npos) {
    return {{file, SpanAt(text, at),
             absl::StrCat("an element with more than ", kMaxAttributes, " attributes"), ""}};
  }
  // A byte order mark (EF BB BF) is stripped by libxml2 itself.
  ContextPtr context(xmlNewParserCtxt());
  if (context == nullptr) return {{file, {}, "out of memory", ""}};
  Run run{text, &file, limits.xml_nesting, limits.xml_elements};
  context->_private = &run;
  xmlSAXHandler& sax = *context->sax;
  sax = {};
  sax.initialized = XML_SAX2_MAGIC;
  sax.internalSubset = OnDocumentType;
  sax.startElementNs = OnStart;
  sax.endElementNs = OnEnd;
  sax.serror = OnError;
  context->userData = context.get();
  // Without libxml2's own limits, of 10 MB for one: those of the document's size and of its elements stand instead.
  xmlCtxtReadMemory(context.get(), text.data(), static_cast<int>(text.size()), nullptr, "UTF-8",
                    XML_PARSE_NONET | XML_PARSE_HUGE);
  if (context->myDoc != nullptr) xmlFreeDoc(context->myDoc);
  context->myDoc = nullptr;
  if (run.diagnostics.empty() && !context->wellFormed) {
    run.diagnostics.push_back({file, SpanAt(text, 0), "XML: not well-formed", ""});
  }
  return run.diagnostics;
}

}  // namespace docent::xml
