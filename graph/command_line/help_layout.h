// The layout of --help. Private to this folder.
#ifndef DOCENT_GRAPH_COMMAND_LINE_HELP_LAYOUT_H_
#define DOCENT_GRAPH_COMMAND_LINE_HELP_LAYOUT_H_

#include <string>

#include "CLI/App.hpp"
#include "CLI/Formatter.hpp"

namespace docent {

class HelpLayout : public CLI::Formatter {
 public:
  HelpLayout();

  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;

 private:
  // A name and what is said of it, two blanks or more between them; a longer name has a line of its own.
  std::string Entry(const std::string& name, const std::string& text) const;
  // `text` wrapped at spaces into lines that fit beside `indent`.
  std::string Wrapped(const std::string& text, size_t indent) const;

  size_t columns_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_COMMAND_LINE_HELP_LAYOUT_H_
