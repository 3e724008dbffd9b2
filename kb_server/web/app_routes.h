// The browser app over HTTP: its files, its page for every view, and what is said where no app is installed.
//
// A path that no other route has is a file of the app or, for a browser that asks for a page, a view: views have URLs, which
// the app reads. Pages come with a strict Content-Security-Policy: no script, style or connection but the app's own.
#ifndef DOCENT_KB_SERVER_WEB_APP_ROUTES_H_
#define DOCENT_KB_SERVER_WEB_APP_ROUTES_H_

#include "kb_server/http/http_server.h"
#include "kb_server/web/app_files.h"

namespace docent::server {

// Stands in the app's pages where a style or script of theirs names the nonce of the policy ("html.cspNonce" of Vite): each
// answer has another one, for libraries that make style elements.
inline constexpr char kNoncePlaceholder[] = "docent-csp-nonce";

// The routes "/", "/visit/code.svg" and whatever no other route has. `app` must outlive the server.
void AddAppRoutes(HttpRoutes* routes, const AppFiles* app);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WEB_APP_ROUTES_H_
