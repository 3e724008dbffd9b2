// /healthz reports what the server can do.
#include <filesystem>
#include <fstream>
#include <thread>

#include "gmock/gmock.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

class ServerHealthTest : public ServerTest {
 protected:
  HttpReply Health() { return HttpClient(http_port()).Ask("GET", "/healthz"); }
  HttpReply Update(const std::string& text) {
    return HttpClient(http_port())
        .Ask("POST", "/sparql", "Content-Type: application/sparql-update\r\n", text);
  }
};

TEST_F(ServerHealthTest, AServerThatServesIsWell) {
  StartServer();
  const HttpReply reply = Health();
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "ok\n");
}

TEST_F(ServerHealthTest, WritesIntoADeletedFolderAreRefusedAndHealthSaysSo) {
  StartServer();
  ASSERT_EQ(Update("INSERT DATA { <urn:a> <urn:b> 1 }").status, 200);
  std::filesystem::remove_all(settings_.data_folder);
  const HttpReply sick = Health();
  EXPECT_EQ(sick.status, 503);
  EXPECT_THAT(sick.body, HasSubstr(settings_.data_folder + " is gone"));
  const HttpReply refused = Update("INSERT DATA { <urn:a> <urn:b> 2 }");
  EXPECT_EQ(refused.status, 503) << refused.body;
  EXPECT_THAT(refused.body, HasSubstr("nothing is written any more"));
  EXPECT_FALSE(Assert(Turtle(":a :b 3 .")).ok());
  EXPECT_EQ(
      HttpClient(http_port()).Ask("GET", "/sparql?query=ASK%7B%3Chttp%3A//x%3E%20%3Fp%20%3Fo%7D").status, 200)
      << "what it has can be read";
  EXPECT_TRUE(server_->Tend()) << "it goes on";
  StopServer();
  EXPECT_FALSE(std::filesystem::exists(settings_.data_folder))
      << "nothing is left there that a start would take";
}

TEST_F(ServerHealthTest, AFolderThatIsPutBackIsUsedAgain) {
  StartServer();
  ASSERT_EQ(Update("INSERT DATA { <urn:a> <urn:b> 1 }").status, 200);
  std::filesystem::rename(settings_.data_folder, folder_ / "elsewhere");
  EXPECT_EQ(Update("INSERT DATA { <urn:a> <urn:b> 2 }").status, 503);
  EXPECT_EQ(Health().status, 503);
  std::filesystem::rename(folder_ / "elsewhere", settings_.data_folder);
  EXPECT_EQ(Update("INSERT DATA { <urn:a> <urn:b> 3 }").status, 200);
  EXPECT_EQ(Health().status, 200);
  StopServer();
  StartServer();
  EXPECT_EQ(Query("ASK { <urn:a> <urn:b> 1, 3 }").header.boolean(), true);
}

TEST_F(ServerHealthTest, AFullDiskIsToldThoughNothingIsWritten) {
  settings_.limits.disk_free_bytes = size_t{1} << 60;  // no disk has that
  StartServer();
  const HttpReply sick = Health();
  EXPECT_EQ(sick.status, 503);
  EXPECT_THAT(sick.body, HasSubstr("disk_free_bytes"));
}

}  // namespace
}  // namespace docent::server::test
