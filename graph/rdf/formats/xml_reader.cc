#include "graph/rdf/formats/xml_reader.h"

#include <libxml/SAX2.h>
#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/xmlerror.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/attribute_counter.h"
#include "graph/rdf/formats/xml_entities.h"

namespace docent {
namespace {

constexpr int kPiece = 4096;  // bytes passed to libxml2 at a time

// libxml2 gives some remarks the level of an error: in XML, namespaces and languages may be any text.
bool IsRemark(int code) {
  return code == XML_WAR_NS_URI || code == XML_WAR_NS_URI_RELATIVE || code == XML_WAR_LANG_VALUE ||
         code == XML_WAR_SPACE_VALUE || code == XML_WAR_ENTITY_REDEFINED;
}

struct ContextDeleter {
  void operator()(xmlParserCtxtPtr context) const { xmlFreeParserCtxt(context); }
};
struct DocumentDeleter {
  void operator()(xmlDocPtr document) const { xmlFreeDoc(document); }
};

std::string_view View(const xmlChar* text) {
  return text == nullptr ? std::string_view() : reinterpret_cast<const char*>(text);
}
std::string_view View(const xmlChar* text, size_t length) {
  return {reinterpret_cast<const char*>(text), length};
}

// libxml2 creates its global tables at its first use, which must happen in one thread.
void InitialiseLibrary() {
  static const bool done = (xmlInitParser(), true);
  (void)done;
}

}  // namespace

// One run of libxml2. The context's `_private` points to this object; contexts that libxml2 makes for the
// texts of entities inherit the pointer. Each callback gets the context that it comes from.
class XmlReader::Parser {
 public:
  explicit Parser(XmlReader* reader)
      : r_(*reader),
        counter_(reader->options_.document_limits.xml_attributes),
        entities_(reader->options_.document_limits, reader->options_.limits.document_bytes,
                  reader->text_.size()) {
    InitialiseLibrary();
    document_.reset(xmlNewParserCtxt());
    context_ = document_.get();
  }

  absl::Status Run() {
    document_->_private = this;
    SetHandlers(document_->sax);
    document_->userData = document_.get();
    const std::unique_ptr<xmlDoc, DocumentDeleter> declarations(
        xmlCtxtReadIO(document_.get(), &Parser::Read, nullptr, this, nullptr, nullptr,
                      XML_PARSE_NOENT | XML_PARSE_NONET | XML_PARSE_HUGE | XML_PARSE_IGNORE_ENC));
    if (document_->wellFormed == 0 && !stopped_ && !r_.mistakes_->has_errors()) {
      r_.mistakes_->Error(r_.text_.size(), "XML: this is not well-formed");
    }
    return status_;
  }

  void Stop() {
    stopped_ = true;
    xmlStopParser(document_.get());
    if (context_ != document_.get()) xmlStopParser(context_);
  }

  size_t EventOffset() const {
    const size_t cursor = Cursor();
    if (context_ != document_.get()) return Backward('&', cursor);
    if (piece_.data() == nullptr) return Backward('<', cursor);
    if (piece_.size() <= cursor && r_.text_.substr(cursor - piece_.size(), piece_.size()) == piece_) {
      return cursor - piece_.size();
    }
    // The text is written in another form: as a reference, in a CDATA section, or with line ends that count
    // as one character.
    const std::string_view before = r_.text_.substr(0, cursor);
    const size_t reference = before.rfind('&'), tag = before.rfind('>');
    if (before.ends_with(';') && reference != std::string_view::npos) return reference;
    return tag == std::string_view::npos ? cursor : tag + 1;
  }

 private:
  using Handler = xmlSAXHandler;

  static Parser& Of(void* context) {
    auto* from = static_cast<xmlParserCtxtPtr>(context);
    Parser& parser = *static_cast<Parser*>(from->_private);
    parser.context_ = from;
    parser.piece_ = {};
    return parser;
  }

  size_t Backward(char c, size_t cursor) const {
    const size_t at = r_.text_.substr(0, cursor).rfind(c);
    return at == std::string_view::npos ? cursor : at;
  }

  // Bytes of the text that libxml2 has consumed.
  size_t Cursor() const {
    if (document_->inputNr <= 0) return handed_;
    const xmlParserInput& input = *document_->inputTab[0];
    if (input.cur == nullptr || input.base == nullptr) return handed_;
    return std::min(input.consumed + static_cast<size_t>(input.cur - input.base), r_.text_.size());
  }

  // False: the document ends here.
  bool Alive(bool now = false) {
    if (stopped_) return false;
    Cancellation* cancellation = r_.options_.cancellation;
    if (cancellation == nullptr) return true;
    status_ = now ? cancellation->CheckNow() : cancellation->Check();
    if (status_.ok()) return true;
    stopped_ = true;
    return false;
  }
  // As Alive, for a callback that may stop libxml2.
  bool Goes() {
    if (Alive()) return true;
    Stop();
    return false;
  }
  void Refuse(size_t offset, std::string message, std::string hint) {
    if (!stopped_) r_.mistakes_->Error(offset, std::move(message), std::move(hint));
    Stop();
  }

  static int Read(void* self, char* to, int room) {
    Parser& parser = *static_cast<Parser*>(self);
    if (!parser.Alive(/*now=*/true)) return 0;
    const std::string_view piece = parser.r_.text_.substr(parser.handed_, std::min(room, kPiece));
    if (const size_t at = parser.counter_.Feed(piece); at != std::string_view::npos) {
      parser.r_.mistakes_->Error(parser.handed_ + at, parser.TooManyAttributes());
      parser.stopped_ = true;  // libxml2 cannot be stopped here: it reads the end of the text
      return 0;
    }
    std::copy(piece.begin(), piece.end(), to);
    parser.handed_ += piece.size();
    return static_cast<int>(piece.size());
  }

  std::string TooManyAttributes() const {
    return absl::StrCat(
        "an element has more attributes and declarations of prefixes than the limit xml_attributes = ",
        r_.options_.document_limits.xml_attributes);
  }

  static void SetHandlers(Handler* sax);
  static void OnStart(void* context, const xmlChar* local, const xmlChar* prefix, const xmlChar* iri,
                      int declarations, const xmlChar** declared, int attributes, int defaulted,
                      const xmlChar** attribute);
  static void OnEnd(void* context, const xmlChar* local, const xmlChar* prefix, const xmlChar* iri);
  static void OnText(void* context, const xmlChar* text, int length);
  static void OnComment(void* context, const xmlChar* text);
  static void OnInstruction(void* context, const xmlChar* target, const xmlChar* data);
  static void OnError(void* context, xmlErrorPtr error);
  static void OnDocumentType(void* context, const xmlChar* name, const xmlChar* public_id,
                             const xmlChar* system);
  static void OnEntityDeclaration(void* context, const xmlChar* name, int type, const xmlChar* public_id,
                                  const xmlChar* system, xmlChar* text);
  static void OnAttributeDeclaration(void* context, const xmlChar* element, const xmlChar* name, int type,
                                     int kind, const xmlChar* value, xmlEnumerationPtr values);
  static xmlEntityPtr FindEntity(void* context, const xmlChar* name);
  static xmlEntityPtr FindParameterEntity(void* context, const xmlChar* name);

  // Counts a declaration of an entity or an attribute. False: beyond the limit.
  bool CountDeclaration() {
    const size_t most = r_.options_.document_limits.xml_declarations;
    if (++declared_ <= most) return true;
    Refuse(
        Cursor(),
        absl::StrCat("the document type definition declares more than the limit xml_declarations = ", most),
        "");
    return false;
  }
  // Counts the use of an entity; null if it is refused.
  xmlEntityPtr Use(xmlEntityPtr entity);
  void CheckScope(const XmlElement& element);
  void ReportUndeclared(std::string_view name);

  XmlReader& r_;
  std::unique_ptr<xmlParserCtxt, ContextDeleter> document_;
  xmlParserCtxtPtr context_ = nullptr;  // of the current callback: the document's, or one of an entity
  std::string_view piece_;              // OnText: the text
  size_t handed_ = 0;                   // bytes passed to libxml2
  bool stopped_ = false;
  absl::Status status_;
  AttributeCounter counter_;
  XmlEntities entities_;
  size_t declared_ = 0;  // in the document type definition
  std::string external_subset_;
  absl::flat_hash_map<std::string, size_t> defaults_;  // attributes of an element that ATTLIST gives a value
  XmlElement element_;                                 // for OnStart
  std::vector<size_t> declarations_;                   // of prefixes in scope, up to each open element
};

void XmlReader::Parser::SetHandlers(Handler* sax) {
  *sax = {};
  sax->initialized = XML_SAX2_MAGIC;
  sax->startDocument = xmlSAX2StartDocument;
  sax->internalSubset = OnDocumentType;
  sax->entityDecl = OnEntityDeclaration;
  sax->attributeDecl = OnAttributeDeclaration;
  sax->getEntity = FindEntity;
  sax->getParameterEntity = FindParameterEntity;
  sax->startElementNs = OnStart;
  sax->endElementNs = OnEnd;
  sax->characters = OnText;
  sax->ignorableWhitespace = OnText;
  sax->cdataBlock = OnText;
  sax->comment = OnComment;
  sax->processingInstruction = OnInstruction;
  sax->serror = OnError;
}

// Checks the depth of elements and the number of prefixes in scope.
void XmlReader::Parser::CheckScope(const XmlElement& element) {
  const DocumentLimits& limits = r_.options_.document_limits;
  const size_t above = declarations_.empty() ? 0 : declarations_.back();
  declarations_.push_back(above + element.declarations.size());
  if (declarations_.size() > static_cast<size_t>(limits.rdf_xml_nesting)) {
    Refuse(EventOffset(),
           absl::StrCat("elements nested deeper than the limit rdf_xml_nesting = ", limits.rdf_xml_nesting),
           "give inner nodes an rdf:nodeID or rdf:about, and describe them at the top");
  } else if (declarations_.back() > limits.xml_attributes) {
    Refuse(EventOffset(),
           absl::StrCat("more prefixes are in scope here than the limit xml_attributes = ",
                        limits.xml_attributes),
           "declare prefixes once, on the first element");
  } else if (element.attributes.size() > limits.xml_attributes) {  // by an entity's text or defaults
    Refuse(EventOffset(), TooManyAttributes(), "");
  }
}

void XmlReader::Parser::OnStart(void* context, const xmlChar* local, const xmlChar* prefix,
                                const xmlChar* iri, int declarations, const xmlChar** declared,
                                int attributes, int, const xmlChar** attribute) {
  Parser& parser = Of(context);
  if (!parser.Goes()) return;
  XmlElement& element = parser.element_;
  element.name = {View(iri), View(prefix), View(local)};
  element.declarations.clear();
  for (int i = 0; i < declarations; ++i, declared += 2) {
    element.declarations.push_back({View(declared[0]), View(declared[1])});
  }
  element.attributes.clear();
  for (int i = 0; i < attributes; ++i, attribute += 5) {
    element.attributes.push_back({{View(attribute[2]), View(attribute[1]), View(attribute[0])},
                                  View(attribute[3], static_cast<size_t>(attribute[4] - attribute[3]))});
  }
  parser.CheckScope(element);
  if (!parser.stopped_) parser.r_.events_->OnStart(element);
}

void XmlReader::Parser::OnEnd(void* context, const xmlChar* local, const xmlChar* prefix,
                              const xmlChar* iri) {
  Parser& parser = Of(context);
  if (!parser.Goes()) return;
  parser.declarations_.pop_back();
  parser.r_.events_->OnEnd({View(iri), View(prefix), View(local)});
}

void XmlReader::Parser::OnText(void* context, const xmlChar* text, int length) {
  Parser& parser = Of(context);
  if (!parser.Goes()) return;
  parser.piece_ = View(text, static_cast<size_t>(length));
  parser.r_.events_->OnText(parser.piece_);
}

void XmlReader::Parser::OnComment(void* context, const xmlChar* text) {
  Parser& parser = Of(context);
  if (parser.Goes() && !parser.declarations_.empty()) parser.r_.events_->OnComment(View(text));
}

void XmlReader::Parser::OnInstruction(void* context, const xmlChar* target, const xmlChar* data) {
  Parser& parser = Of(context);
  if (parser.Goes() && !parser.declarations_.empty())
    parser.r_.events_->OnInstruction(View(target), View(data));
}

void XmlReader::Parser::ReportUndeclared(std::string_view name) {
  std::string hint;
  if (entities_.IsExternal(name)) {
    hint = "its text lies in another file, and nothing is fetched; declare it by its text";
  } else if (!external_subset_.empty()) {
    hint = Concat("declare it by its text: <!ENTITY ", name, " \"…\">; the external subset <",
                  external_subset_, "> is not read");
  } else {
    hint = Concat("declare it in <!DOCTYPE rdf:RDF [ <!ENTITY ", name, " \"…\"> ]>, or write & as &amp;");
  }
  r_.mistakes_->Error(Backward('&', Cursor()), Concat("the entity &", name, "; is not declared"),
                      std::move(hint));
}

void XmlReader::Parser::OnError(void* context, xmlErrorPtr error) {
  Parser& parser = Of(context);
  const bool undeclared =
      error->code == XML_ERR_UNDECLARED_ENTITY || error->code == XML_WAR_UNDECLARED_ENTITY;
  if (parser.stopped_ || (error->level < XML_ERR_ERROR && !undeclared) || IsRemark(error->code)) return;
  if (undeclared && error->str1 != nullptr) {
    parser.ReportUndeclared(error->str1);
  } else {
    const absl::string_view message =
        absl::StripAsciiWhitespace(error->message != nullptr ? error->message : "this is not well-formed");
    parser.r_.mistakes_->Error(parser.Cursor(), absl::StrCat("XML: ", message),
                               error->code == XML_ERR_LT_IN_ATTRIBUTE ? "write < as &lt;" : "");
  }
  if (error->level == XML_ERR_FATAL || parser.r_.mistakes_->full()) parser.Stop();
}

void XmlReader::Parser::OnDocumentType(void* context, const xmlChar* name, const xmlChar* public_id,
                                       const xmlChar* system) {
  Parser& parser = Of(context);
  if (!parser.Goes()) return;
  parser.external_subset_ = View(system);
  xmlSAX2InternalSubset(context, name, public_id, system);
}

void XmlReader::Parser::OnEntityDeclaration(void* context, const xmlChar* name, int type,
                                            const xmlChar* public_id, const xmlChar* system, xmlChar* text) {
  Parser& parser = Of(context);
  if (!parser.Goes() || !parser.CountDeclaration()) return;
  if (type == XML_INTERNAL_GENERAL_ENTITY) {
    AttributeCounter counter(parser.r_.options_.document_limits.xml_attributes);
    if (counter.Feed(View(text)) != std::string_view::npos) {
      return parser.Refuse(parser.Cursor(), parser.TooManyAttributes(), "");
    }
    parser.entities_.Declare(View(name), View(text));
  } else if (type == XML_EXTERNAL_PARAMETER_ENTITY) {  // its uses are skipped: it has no text
    static xmlChar no_text[1] = {0};
    return xmlSAX2EntityDecl(context, name, XML_INTERNAL_PARAMETER_ENTITY, nullptr, nullptr, no_text);
  } else if (type != XML_INTERNAL_PARAMETER_ENTITY) {
    return parser.entities_.DeclareExternal(View(name));
  }
  xmlSAX2EntityDecl(context, name, type, public_id, system, text);
}

void XmlReader::Parser::OnAttributeDeclaration(void* context, const xmlChar* element, const xmlChar*, int,
                                               int, const xmlChar* value, xmlEnumerationPtr values) {
  Parser& parser = Of(context);
  xmlFreeEnumeration(values);
  if (!parser.Goes() || !parser.CountDeclaration() || value == nullptr) return;
  if (++parser.defaults_[std::string(View(element))] > parser.r_.options_.document_limits.xml_attributes) {
    parser.Refuse(parser.Cursor(), parser.TooManyAttributes(), "");
  }
}

xmlEntityPtr XmlReader::Parser::Use(xmlEntityPtr entity) {
  if (entity == nullptr || !Goes()) return nullptr;
  const size_t bytes = static_cast<size_t>(std::max(entity->length, 0));
  if (entities_.Use(View(entity->name), bytes)) return entity;
  Refuse(Backward('&', Cursor()), entities_.why(), "write the text itself");
  return nullptr;
}

xmlEntityPtr XmlReader::Parser::FindEntity(void* context, const xmlChar* name) {
  Parser& parser = Of(context);
  const xmlEntityPtr entity = xmlSAX2GetEntity(parser.document_.get(), name);
  // libxml2 also looks up each entity right after its declaration.
  const bool declares =
      parser.context_->inSubset != 0 && parser.context_->instate != XML_PARSER_ATTRIBUTE_VALUE;
  return declares ? entity : parser.Use(entity);
}

xmlEntityPtr XmlReader::Parser::FindParameterEntity(void* context, const xmlChar* name) {
  Parser& parser = Of(context);
  return parser.Use(xmlSAX2GetParameterEntity(parser.document_.get(), name));
}

XmlReader::XmlReader(std::string_view text, const ParseRdfOptions& options, XmlEvents* events,
                     MistakeList* mistakes)
    : text_(text), options_(options), events_(events), mistakes_(mistakes) {}

absl::Status XmlReader::Run() {
  Parser parser(this);
  parser_ = &parser;
  absl::Status status = parser.Run();
  parser_ = nullptr;
  return status;
}

void XmlReader::Stop() {
  parser_->Stop();
}

size_t XmlReader::EventOffset() const {
  return parser_->EventOffset();
}

// Finds the names of all attributes of the tag at `start`.
void XmlReader::IndexAttributes(size_t start) {
  indexed_tag_ = start;
  attribute_offsets_.clear();
  for (size_t at = start; at < text_.size() && text_[at] != '>'; ++at) {
    if (text_[at] == '"' || text_[at] == '\'') {
      at = std::min(text_.find(text_[at], at + 1), text_.size());
    } else if (at > start && absl::ascii_isspace(static_cast<unsigned char>(text_[at - 1]))) {
      const size_t end = std::min(text_.find_first_of("= \t\r\n>", at), text_.size());
      if (end > at) attribute_offsets_.try_emplace(text_.substr(at, end - at), at);
    }
  }
}

size_t XmlReader::AttributeOffset(const XmlName& name) {
  const size_t start = EventOffset();
  if (start != indexed_tag_) IndexAttributes(start);
  const std::string written =
      name.prefix.empty() ? std::string(name.local) : Concat(name.prefix, ":", name.local);
  const auto found = attribute_offsets_.find(written);
  return found == attribute_offsets_.end() ? start : found->second;
}

}  // namespace docent
