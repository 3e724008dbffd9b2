// Messages that must not grow with the texts that users and robots gave. Any thread.
#ifndef DOCENT_GRAPH_WIRE_TEXT_CUT_H_
#define DOCENT_GRAPH_WIRE_TEXT_CUT_H_

#include <google/protobuf/message.h>

#include <cstddef>

namespace docent {

// Every text of the message, and of those in it, that has more than `most` bytes is cut to them (graph/base/cut_text.h). True:
// there was one.
bool CutTexts(google::protobuf::Message* message, size_t most);

// The same, and shorter again until the message has at most `bytes`, or each text is down to a line.
bool CutToFit(google::protobuf::Message* message, size_t most, size_t bytes);

}  // namespace docent

#endif  // DOCENT_GRAPH_WIRE_TEXT_CUT_H_
