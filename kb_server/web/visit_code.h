// QR codes that hang at booths: the address of the visitors' page, which names the booth, as a picture in SVG. libqrencode does
// not show here. Pure functions.
#ifndef DOCENT_KB_SERVER_WEB_VISIT_CODE_H_
#define DOCENT_KB_SERVER_WEB_VISIT_CODE_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/base/web_limits.h"

namespace docent::server {

// "https://expo.example", "B05" → "https://expo.example/visit?at=B05". `base` is the address under which phones reach the
// server; `place` is the IRI, prefixed name, end of the IRI or name of a booth or region. INVALID_ARGUMENT: `base` is no
// address of HTTP, `place` is empty or no UTF-8; RESOURCE_EXHAUSTED: the limit visit_code_bytes.
absl::StatusOr<std::string> VisitAddress(std::string_view base, std::string_view place,
                                         const WebLimits& limits = {});

// The QR code of `text` (ISO/IEC 18004, error correction M: 15 % of it may be hidden or dirty), with the quiet zone that
// readers need, black on white. `label` stands below it for people; empty: nothing does. RESOURCE_EXHAUSTED: `text` is
// longer than visit_code_bytes.
absl::StatusOr<std::string> QrCodeSvg(const std::string& text, std::string_view label,
                                      const WebLimits& limits = {});

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WEB_VISIT_CODE_H_
