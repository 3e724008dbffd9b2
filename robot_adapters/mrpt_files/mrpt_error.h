// Message of an MRPT exception for people: its first line, without the stack trace. Pure; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_ERROR_H_
#define DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_ERROR_H_

#include <exception>
#include <string>

namespace docent::robot {

inline std::string MrptMessage(const std::exception& error) {
  const std::string text = error.what();
  const size_t begin = text.find_first_not_of(" \n\t=");
  if (begin == std::string::npos) return "unknown error";
  return text.substr(begin, text.find('\n', begin) - begin);
}

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_ERROR_H_
