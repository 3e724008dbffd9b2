#include "kb_server/work/mqtt_publish.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "graph/base/cancellation.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

// A broker for one client, which answers its two packets with these bytes.
class Broker {
 public:
  Broker(std::string connack, std::string puback) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, connack = std::move(connack), puback = std::move(puback)] {
      const int client = accept(listener_, nullptr, nullptr);
      char buffer[1000];
      for (const std::string& answer : {connack, puback}) {
        if (recv(client, buffer, sizeof(buffer), 0) <= 0) break;
        (void)!send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
      }
      (void)!recv(client, buffer, sizeof(buffer), 0);  // until it goes
      close(client);
    });
  }
  ~Broker() {
    thread_.join();
    close(listener_);
  }
  absl::Status Publish() const {
    Cancellation cancellation;
    return PublishToMqtt(absl::StrCat("127.0.0.1:", port_), "a/b", "{}", std::chrono::seconds(30),
                         &cancellation);
  }

 private:
  int listener_ = -1;
  int port_ = 0;
  std::thread thread_;
};

const std::string kConnack("\x20\x02\x00\x00", 4);

TEST(MqttPublishTest, AMessageIsDeliveredWhenItIsAcknowledged) {
  EXPECT_TRUE(Broker(kConnack, std::string("\x40\x02\x00\x01", 4)).Publish().ok());
}

TEST(MqttPublishTest, TheAcknowledgementOfAnotherPacketIsNone) {
  for (const char* puback :
       {"\x40\x02\x00\x02", "\x40\x02\x01\x00", "\x40\x03\x00\x01", "\x50\x02\x00\x01"}) {
    const absl::Status status = Broker(kConnack, std::string(puback, 4)).Publish();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(status.message()), HasSubstr("does not acknowledge"));
  }
}

TEST(MqttPublishTest, ARefusedConnectionIsSaid) {
  const absl::Status status = Broker(std::string("\x20\x02\x00\x05", 4), "").Publish();
  EXPECT_THAT(std::string(status.message()), HasSubstr("refuses the connection, code 5"));
}

}  // namespace
}  // namespace docent::server
