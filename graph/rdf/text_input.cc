#include "graph/rdf/text_input.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/utf8.h"

namespace docent {

absl::StatusOr<std::string> ReadBytes(const std::string& path) {
  std::ostringstream text;
  if (path == "-") {
    text << std::cin.rdbuf();
    return text.str();
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
  // a directory can be opened, and then reads as if it were empty
  if (std::error_code error; std::filesystem::is_directory(path, error))
    return absl::InvalidArgumentError(absl::StrCat(path, " is a directory; name its files"));
  text << file.rdbuf();
  if (file.bad())
    return absl::UnavailableError(absl::StrCat("reading ", path, " failed: ", std::strerror(errno)));
  return text.str();
}

absl::StatusOr<std::string> ReadText(const std::string& path) {
  auto text = ReadBytes(path);
  if (!text.ok()) return text;
  if (absl::Status status = CheckUtf8(*text, path == "-" ? "stdin" : path); !status.ok()) return status;
  return text;
}

absl::Status CheckUtf8(const std::string& text, const std::string& file) {
  const auto bad = FindInvalidUtf8(text);
  if (!bad) return absl::OkStatus();
  // SpanAt would count code points in what is no UTF-8
  const SourceSpan span = SpanAt(std::string_view(text).substr(0, *bad), *bad);
  const std::string message =
      absl::StrFormat("the byte 0x%02X here is not UTF-8", static_cast<unsigned char>(text[*bad]));
  return ToStatus({{file, span, message, "save the text as UTF-8"}}, text);
}

absl::StatusOr<std::string> GivenText(const std::string& what, const std::string& argument,
                                      const std::string& file) {
  if (!file.empty()) return ReadText(file);
  if (argument.empty())
    return absl::InvalidArgumentError(
        absl::StrCat("no ", what, " given; pass it as an argument or with --file"));
  if (absl::Status status = CheckUtf8(argument, ""); !status.ok()) return status;
  return argument;
}

}  // namespace docent
