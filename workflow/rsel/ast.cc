#include "workflow/rsel/ast.h"

namespace docent::rsel {

const Message* Document::FindMessage(std::string_view message_name) const {
  for (const Message& message : messages) {
    if (message.name.value == message_name) return &message;
  }
  return nullptr;
}

const Process* Document::FindProcess(std::string_view process_name) const {
  for (const Process& process : processes) {
    if (process.name.value == process_name) return &process;
  }
  return nullptr;
}

}  // namespace docent::rsel
