#include "kb_server/cli/run_name.h"

#include <functional>

#include "absl/strings/ascii.h"
#include "graph/rdf/docent_iris.h"

namespace docent::server {
namespace {

bool IsEscape(std::string_view text) {
  return text.size() >= 3 && text[0] == '%' && absl::ascii_isxdigit(static_cast<unsigned char>(text[1])) &&
         absl::ascii_isxdigit(static_cast<unsigned char>(text[2]));
}

}  // namespace

std::string RunIdOf(std::string_view text) {
  std::string id;
  while (!text.empty()) {
    const size_t length = IsEscape(text) ? 3 : 1;
    id += length == 3 ? std::string(text.substr(0, 3)) : IriSegment(text.substr(0, 1));
    text.remove_prefix(length);
  }
  return id;
}

CLI::Option* TakesRunName(CLI::Option* option) {
  return option->transform(
      std::function<std::string(std::string)>([](const std::string& text) { return RunIdOf(text); }));
}

}  // namespace docent::server
