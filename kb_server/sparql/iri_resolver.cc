#include "kb_server/sparql/iri_resolver.h"

#include <cctype>

#include "kb_server/sparql/text.h"

namespace docent::sparql {
namespace {

struct IriParts {
  std::string_view scheme, authority, path, query, fragment;  // with their punctuation, authority with "//"
};

IriParts Split(std::string_view iri) {
  IriParts parts;
  if (const size_t hash = iri.find('#'); hash != std::string_view::npos) {
    parts.fragment = iri.substr(hash);
    iri = iri.substr(0, hash);
  }
  if (const size_t mark = iri.find('?'); mark != std::string_view::npos) {
    parts.query = iri.substr(mark);
    iri = iri.substr(0, mark);
  }
  if (IsAbsoluteIri(iri)) {
    const size_t colon = iri.find(':');
    parts.scheme = iri.substr(0, colon + 1);
    iri = iri.substr(colon + 1);
  }
  if (iri.substr(0, 2) == "//") {
    const size_t slash = iri.find('/', 2);
    parts.authority = iri.substr(0, slash);
    iri = slash == std::string_view::npos ? std::string_view() : iri.substr(slash);
  }
  parts.path = iri;
  return parts;
}

// RFC 3986 section 5.2.4
std::string RemoveDotSegments(std::string_view in) {
  std::string out;
  const auto drop_last = [&out] {
    const size_t slash = out.rfind('/');
    out.resize(slash == std::string::npos ? 0 : slash);
  };
  while (!in.empty()) {
    if (in.substr(0, 3) == "../") {
      in.remove_prefix(3);
    } else if (in.substr(0, 2) == "./" || in.substr(0, 3) == "/./") {
      in.remove_prefix(2);
    } else if (in == "/.") {
      in = "/";
    } else if (in.substr(0, 4) == "/../") {
      in.remove_prefix(3);
      drop_last();
    } else if (in == "/..") {
      in = "/";
      drop_last();
    } else if (in == "." || in == "..") {
      in = "";
    } else {
      const size_t slash = in.find('/', 1);
      out.append(in.substr(0, slash));
      in = slash == std::string_view::npos ? std::string_view() : in.substr(slash);
    }
  }
  return out;
}

}  // namespace

bool IsAbsoluteIri(std::string_view iri) {
  if (iri.empty() || !std::isalpha(static_cast<unsigned char>(iri[0]))) return false;
  for (const char c : iri) {
    if (c == ':') return true;
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  }
  return false;
}

std::string ResolveIri(std::string_view base, std::string_view reference) {
  if (IsAbsoluteIri(reference)) return std::string(reference);
  const IriParts b = Split(base);
  const IriParts r = Split(reference);
  if (!r.authority.empty()) {
    return Concat({b.scheme, r.authority, RemoveDotSegments(r.path), r.query, r.fragment});
  }
  if (r.path.empty()) {
    return Concat({b.scheme, b.authority, b.path, r.query.empty() ? b.query : r.query, r.fragment});
  }
  std::string path;
  if (r.path[0] == '/') {
    path = std::string(r.path);
  } else if (!b.authority.empty() && b.path.empty()) {
    path = Concat({"/", r.path});
  } else {
    const size_t slash = b.path.rfind('/');
    path = Concat({slash == std::string_view::npos ? std::string_view() : b.path.substr(0, slash + 1), r.path});
  }
  return Concat({b.scheme, b.authority, RemoveDotSegments(path), r.query, r.fragment});
}

}  // namespace docent::sparql
