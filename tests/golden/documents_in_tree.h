// The CAWL and RSEL documents of the tree: those of the scenarios, the whole ones of docs/, and the inputs of the golden tests.
#ifndef DOCENT_TESTS_GOLDEN_DOCUMENTS_IN_TREE_H_
#define DOCENT_TESTS_GOLDEN_DOCUMENTS_IN_TREE_H_

#include <string>
#include <utility>
#include <vector>

#include "tests/golden/golden_file.h"

namespace docent::golden {

struct TreeDocument {
  std::string place;  // for messages
  std::string text;
  bool shipped;  // of a scenario or of docs/: there must be no fault in it
};

// Blocks ```xml of a page whose root element is `root`.
inline void AddBlocks(const std::filesystem::path& page, const std::string& root,
                      std::vector<TreeDocument>* out) {
  const std::string text = ReadFile(page), open = "\n```xml";
  for (size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
    const size_t begin = text.find('\n', at + 1) + 1, end = text.find("\n```", begin);
    const std::string block = text.substr(begin, end + 1 - begin);
    size_t first = block.starts_with("<?xml") ? block.find('\n') + 1 : 0;
    if (block.compare(first, root.size() + 1, "<" + root) == 0)
      out->push_back({page.filename().string() + " at " + std::to_string(begin), block, true});
  }
}

// `root`: "CAWL" or "rsel".
inline std::vector<TreeDocument> DocumentsInTree(const std::string& root) {
  namespace fs = std::filesystem;
  const fs::path tree = DOCENT_SOURCE_DIR;
  const std::string kind = root == "CAWL" ? "cawl" : "rsel";
  std::vector<TreeDocument> out;
  for (const auto& entry : fs::recursive_directory_iterator(tree / "scenarios")) {
    const std::string name = entry.path().string();
    if (name.ends_with("." + kind + ".xml")) out.push_back({name, ReadFile(entry.path()), true});
  }
  for (const auto& entry : fs::recursive_directory_iterator(tree / "docs")) {
    if (entry.path().extension() == ".md") AddBlocks(entry.path(), root, &out);
  }
  for (const std::string& name : Cases(kind)) {
    const fs::path file = tree / "tests/golden" / kind / name / "input.xml";
    if (fs::exists(file)) out.push_back({kind + "/" + name, ReadFile(file), false});
  }
  return out;
}

}  // namespace docent::golden

#endif  // DOCENT_TESTS_GOLDEN_DOCUMENTS_IN_TREE_H_
