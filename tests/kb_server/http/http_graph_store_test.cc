// The handlers of the Graph Store Protocol, without a server and without a connection.
#include "kb_server/http/http_graph_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/synchronization/notification.h"
#include "tests/kb_server/handler_world.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

class GraphStoreHandlersTest : public ::testing::Test {
 protected:
  GraphStoreHandlersTest() { AddGraphStoreRoutes(&routes_, &world_.ports); }

  HttpResponse Ask(const std::string& method, const std::string& body = "") {
    HttpRequest request;
    request.method = method;
    request.path = request.raw_path = "/rdf-graphs";
    request.parameters = {{"graph", "urn:g"}};
    request.headers = {{"content-type", "text/turtle"}};
    request.body = body;
    HttpResponse refusal;
    const HttpRoute* route = routes_.Find(request, &refusal);
    if (route == nullptr) return refusal;
    const auto answer = std::make_shared<HttpAnswer>();
    absl::Notification answered;
    answer->OnProgress([&answered] { answered.Notify(); });
    route->handler(std::make_shared<HttpExchange>(std::move(request), answer));
    answered.WaitForNotification();
    return *answer->Take().head;
  }

  HttpRoutes routes_;
  test::HandlerWorld world_;
};

TEST_F(GraphStoreHandlersTest, AGraphIsMadeReadAndDropped) {
  EXPECT_EQ(Ask("GET").status, 404);
  const HttpResponse made = Ask("PUT", "<urn:a> <urn:p> 1 .");
  EXPECT_EQ(made.status, 201) << made.body;
  EXPECT_THAT(made.body, HasSubstr("\"added\":1"));
  const HttpResponse read = Ask("GET");
  EXPECT_EQ(read.status, 200);
  EXPECT_THAT(read.body, HasSubstr("<urn:a> <urn:p> 1"));
  EXPECT_EQ(Ask("DELETE").status, 200);
  EXPECT_EQ(Ask("DELETE").status, 404);
}

TEST_F(GraphStoreHandlersTest, WhatIsWrongIsSaid) {
  const HttpResponse bad = Ask("PUT", "<urn:a> <urn:p> .");
  EXPECT_EQ(bad.status, 400);
  EXPECT_THAT(bad.body, HasSubstr("1:17"));
  EXPECT_EQ(Ask("TRACE").status, 405);
}

}  // namespace
}  // namespace docent::server
