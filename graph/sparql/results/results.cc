#include "graph/sparql/results/results.h"

#include <algorithm>
#include <cstdio>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::sparql {
namespace {

void AppendJsonString(std::string_view text, std::string* out) {
  out->push_back('"');
  for (const char c : text) {
    switch (c) {
      case '"':
        *out += "\\\"";
        break;
      case '\\':
        *out += "\\\\";
        break;
      case '\n':
        *out += "\\n";
        break;
      case '\r':
        *out += "\\r";
        break;
      case '\t':
        *out += "\\t";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20) {
          char buffer[8];
          std::snprintf(buffer, sizeof buffer, "\\u%04x", c);
          *out += buffer;
        } else {
          out->push_back(c);
        }
    }
  }
  out->push_back('"');
}

// Characters that XML 1.0 (section 2.2) cannot express (control characters, U+FFFE, U+FFFF) become U+FFFD.
void AppendXmlText(std::string_view text, std::string* out) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    switch (c) {
      case '&':
        *out += "&amp;";
        break;
      case '<':
        *out += "&lt;";
        break;
      case '>':
        *out += "&gt;";
        break;
      case '"':
        *out += "&quot;";
        break;
      case '\r':
        *out += "&#13;";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') {
          *out += kReplacement;
        } else if (const std::string_view next = text.substr(i, 3);
                   next == "\xEF\xBF\xBE" || next == "\xEF\xBF\xBF") {
          *out += kReplacement;
          i += 2;
        } else {
          out->push_back(c);
        }
    }
  }
}

// SPARQL 1.1 Query Results JSON Format
class JsonWriter final : public ResultWriter {
 public:
  explicit JsonWriter(std::string* out) : out_(*out) {}
  void Begin(const std::vector<std::string>& variables) override {
    names_ = variables;
    out_ += "{\"head\":{\"vars\":[";
    for (size_t i = 0; i < names_.size(); ++i) {
      if (i > 0) out_ += ',';
      AppendJsonString(names_[i], &out_);
    }
    out_ += "]},\"results\":{\"bindings\":[";
  }
  void Row(absl::Span<const std::optional<Term>> terms) override {
    out_ += first_ ? "\n{" : ",\n{";
    first_ = false;
    bool first_cell = true;
    for (size_t i = 0; i < terms.size() && i < names_.size(); ++i) {
      if (!terms[i]) continue;
      if (!first_cell) out_ += ',';
      first_cell = false;
      AppendJsonString(names_[i], &out_);
      out_ += ':';
      Cell(*terms[i]);
    }
    out_ += '}';
  }
  void End() override { out_ += "\n]}}\n"; }

 private:
  void Cell(const Term& t) {
    out_ += t.IsIri()     ? "{\"type\":\"uri\",\"value\":"
            : t.IsBlank() ? "{\"type\":\"bnode\",\"value\":"
                          : "{\"type\":\"literal\",\"value\":";
    AppendJsonString(t.lexical, &out_);
    if (!t.language.empty()) {
      out_ += ",\"xml:lang\":";
      AppendJsonString(t.language, &out_);
    } else if (t.IsLiteral() && !t.datatype.empty()) {
      out_ += ",\"datatype\":";
      AppendJsonString(t.datatype, &out_);
    }
    out_ += '}';
  }

  std::string& out_;
  std::vector<std::string> names_;
  bool first_ = true;
};

// SPARQL Query Results XML Format (Second Edition)
class XmlWriter final : public ResultWriter {
 public:
  explicit XmlWriter(std::string* out) : out_(*out) {}
  void Begin(const std::vector<std::string>& variables) override {
    names_ = variables;
    out_ += "<?xml version=\"1.0\"?>\n<sparql xmlns=\"http://www.w3.org/2005/sparql-results#\">\n<head>";
    for (const std::string& name : names_) {
      out_ += "<variable name=\"";
      AppendXmlText(name, &out_);
      out_ += "\"/>";
    }
    out_ += "</head>\n<results>\n";
  }
  void Row(absl::Span<const std::optional<Term>> terms) override {
    out_ += "<result>";
    for (size_t i = 0; i < terms.size() && i < names_.size(); ++i) {
      if (!terms[i]) continue;
      out_ += "<binding name=\"";
      AppendXmlText(names_[i], &out_);
      out_ += "\">";
      Cell(*terms[i]);
      out_ += "</binding>";
    }
    out_ += "</result>\n";
  }
  void End() override { out_ += "</results>\n</sparql>\n"; }

 private:
  void Cell(const Term& t) {
    const std::string_view tag = t.IsIri() ? "uri" : t.IsBlank() ? "bnode" : "literal";
    out_ += Concat("<", tag);
    if (!t.language.empty()) {
      out_ += " xml:lang=\"";
      AppendXmlText(t.language, &out_);
      out_ += '"';
    } else if (t.IsLiteral() && !t.datatype.empty()) {
      out_ += " datatype=\"";
      AppendXmlText(t.datatype, &out_);
      out_ += '"';
    }
    out_ += '>';
    AppendXmlText(t.lexical, &out_);
    out_ += Concat("</", tag, ">");
  }

  std::string& out_;
  std::vector<std::string> names_;
};

// SPARQL 1.1 Query Results CSV and TSV Formats, section 3
class CsvWriter final : public ResultWriter {
 public:
  explicit CsvWriter(std::string* out) : out_(*out) {}
  void Begin(const std::vector<std::string>& variables) override {
    for (size_t i = 0; i < variables.size(); ++i) out_ += (i ? "," : "") + variables[i];
    out_ += "\r\n";
  }
  void Row(absl::Span<const std::optional<Term>> terms) override {
    for (size_t i = 0; i < terms.size(); ++i) {
      if (i > 0) out_ += ',';
      if (terms[i]) Cell(*terms[i]);
    }
    out_ += "\r\n";
  }
  void End() override {}

 private:
  void Cell(const Term& t) {
    const std::string text = t.IsBlank() ? "_:" + t.lexical : t.lexical;
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
      out_ += text;
      return;
    }
    out_ += '"';
    for (const char c : text) {
      if (c == '"') out_ += '"';
      out_ += c;
    }
    out_ += '"';
  }

  std::string& out_;
};

// Section 4: terms in the syntax of SPARQL and Turtle, numbers bare
class TsvWriter final : public ResultWriter {
 public:
  explicit TsvWriter(std::string* out) : out_(*out) {}
  void Begin(const std::vector<std::string>& variables) override {
    for (size_t i = 0; i < variables.size(); ++i) out_ += (i ? "\t?" : "?") + variables[i];
    out_ += '\n';
  }
  void Row(absl::Span<const std::optional<Term>> terms) override {
    for (size_t i = 0; i < terms.size(); ++i) {
      if (i > 0) out_ += '\t';
      if (!terms[i]) continue;
      out_ += IsBareNumber(*terms[i]) ? terms[i]->lexical : EscapeTabs(ToNTriples(*terms[i]));
    }
    out_ += '\n';
  }
  void End() override {}

 private:
  static std::string EscapeTabs(const std::string& text) {
    std::string out;
    for (const char c : text) {
      if (c == '\t') {
        out += "\\t";
      } else {
        out += c;
      }
    }
    return out;
  }
  // INTEGER, DECIMAL and DOUBLE of the grammar, with a sign: [0-9]+, [0-9]*.[0-9]+, and those with an
  // exponent.
  static bool IsBareNumber(const Term& t) {
    std::string_view rest = t.lexical;
    const auto digits = [&rest] {
      const size_t count = std::min(rest.find_first_not_of("0123456789"), rest.size());
      rest.remove_prefix(count);
      return count;
    };
    const auto one_of = [&rest](std::string_view characters) {
      const bool there = !rest.empty() && characters.find(rest[0]) != std::string_view::npos;
      if (there) rest.remove_prefix(1);
      return there;
    };
    one_of("+-");
    const size_t before = digits();
    const bool point = one_of(".");
    const size_t after = point ? digits() : 0;
    if (t.datatype == kXsdInteger) return before > 0 && !point && rest.empty();
    if (t.datatype == kXsdDecimal) return after > 0 && rest.empty();
    if (t.datatype != kXsdDouble || before + after == 0 || !one_of("eE")) return false;
    one_of("+-");
    return digits() > 0 && rest.empty();
  }

  std::string& out_;
};

}  // namespace

std::optional<ResultFormat> ResultFormatOfName(std::string_view name) {
  if (name == "json") return ResultFormat::kJson;
  if (name == "xml") return ResultFormat::kXml;
  if (name == "csv") return ResultFormat::kCsv;
  if (name == "tsv") return ResultFormat::kTsv;
  return std::nullopt;
}

std::unique_ptr<ResultWriter> ResultWriter::Make(ResultFormat format, std::string* out) {
  switch (format) {
    case ResultFormat::kJson:
      return std::make_unique<JsonWriter>(out);
    case ResultFormat::kXml:
      return std::make_unique<XmlWriter>(out);
    case ResultFormat::kCsv:
      return std::make_unique<CsvWriter>(out);
    case ResultFormat::kTsv:
      return std::make_unique<TsvWriter>(out);
  }
  return nullptr;
}

std::string WriteBoolean(bool value, ResultFormat format) {
  const std::string word = value ? "true" : "false";
  switch (format) {
    case ResultFormat::kJson:
      return "{\"head\":{},\"boolean\":" + word + "}\n";
    case ResultFormat::kXml:
      return "<?xml version=\"1.0\"?>\n<sparql "
             "xmlns=\"http://www.w3.org/2005/sparql-results#\">\n<head/>\n<boolean>" +
             word + "</boolean>\n</sparql>\n";
    default:
      return word + "\n";
  }
}

}  // namespace docent::sparql
