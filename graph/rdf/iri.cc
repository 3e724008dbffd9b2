#include "graph/rdf/iri.h"

#include "absl/strings/ascii.h"
#include "graph/base/text.h"

namespace docent {
namespace {

// The parts of RFC 3986 appendix B, as views; `has_…` tells an empty part from an absent one.
struct IriParts {
  std::string_view scheme;
  std::string_view authority;
  std::string_view path;
  std::string_view query;
  std::string_view fragment;
  bool has_authority = false;
  bool has_query = false;
  bool has_fragment = false;
};

IriParts Split(std::string_view iri) {
  IriParts parts;
  if (IsAbsoluteIri(iri)) {
    size_t colon = iri.find(':');
    parts.scheme = iri.substr(0, colon);
    iri.remove_prefix(colon + 1);
  }
  if (size_t hash = iri.find('#'); hash != std::string_view::npos) {
    parts.fragment = iri.substr(hash + 1);
    parts.has_fragment = true;
    iri = iri.substr(0, hash);
  }
  if (size_t mark = iri.find('?'); mark != std::string_view::npos) {
    parts.query = iri.substr(mark + 1);
    parts.has_query = true;
    iri = iri.substr(0, mark);
  }
  if (iri.starts_with("//")) {
    size_t end = iri.find('/', 2);
    if (end == std::string_view::npos) end = iri.size();
    parts.authority = iri.substr(2, end - 2);
    parts.has_authority = true;
    iri.remove_prefix(end);
  }
  parts.path = iri;
  return parts;
}

// RFC 3986 section 5.2.4.
std::string RemoveDotSegments(std::string_view in) {
  std::string out;
  auto drop_last = [&out] { out.erase(out.rfind('/') == std::string::npos ? 0 : out.rfind('/')); };
  while (!in.empty()) {
    if (in.starts_with("../")) {
      in.remove_prefix(3);
    } else if (in.starts_with("./") || in.starts_with("/./")) {
      in.remove_prefix(2);
    } else if (in == "/.") {
      in = "/";
    } else if (in.starts_with("/../")) {
      in.remove_prefix(3);
      drop_last();
    } else if (in == "/..") {
      in = "/";
      drop_last();
    } else if (in == "." || in == "..") {
      in = {};
    } else {
      size_t end = in.find('/', 1);
      if (end == std::string_view::npos) end = in.size();
      out += in.substr(0, end);
      in.remove_prefix(end);
    }
  }
  return out;
}

// RFC 3986 section 5.2.3.
std::string Merge(const IriParts& base, std::string_view path) {
  if (base.has_authority && base.path.empty()) return Concat("/", path);
  size_t slash = base.path.rfind('/');
  if (slash == std::string_view::npos) return std::string(path);
  return Concat(base.path.substr(0, slash + 1), path);
}

}  // namespace

bool IsAbsoluteIri(std::string_view iri) {
  if (iri.empty() || !absl::ascii_isalpha(static_cast<unsigned char>(iri[0]))) return false;
  for (char c : iri) {
    if (c == ':') return true;
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  }
  return false;
}

bool IsValidTermIri(std::string_view iri) {
  if (!IsAbsoluteIri(iri)) return false;
  for (char c : iri) {
    if (IsForbiddenInIri(static_cast<unsigned char>(c))) return false;
  }
  return true;
}

std::string ResolveIri(std::string_view reference, std::string_view base) {
  if (IsAbsoluteIri(reference)) return std::string(reference);
  IriParts from = Split(base);
  IriParts to = Split(reference);
  std::string path;
  bool keep_query = false;
  if (to.has_authority) {
    path = RemoveDotSegments(to.path);
  } else {
    to.authority = from.authority;
    to.has_authority = from.has_authority;
    if (to.path.empty()) {
      path = from.path;
      keep_query = !to.has_query;
    } else if (to.path.starts_with('/')) {
      path = RemoveDotSegments(to.path);
    } else {
      path = RemoveDotSegments(Merge(from, to.path));
    }
  }
  std::string out = Concat(from.scheme, ":");
  if (to.has_authority) out += Concat("//", to.authority);
  out += path;
  if (keep_query ? from.has_query : to.has_query) out += Concat("?", keep_query ? from.query : to.query);
  if (to.has_fragment) out += Concat("#", to.fragment);
  return out;
}

}  // namespace docent
