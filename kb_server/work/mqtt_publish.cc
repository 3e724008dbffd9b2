#include "kb_server/work/mqtt_publish.h"

#include <utility>  // before Asio: Boost 1.74 uses std::exchange in its coroutines without including it

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "kb_server/work/http_message.h"

namespace docent::server {
namespace {

namespace net = boost::asio;
using tcp = net::ip::tcp;

constexpr std::chrono::milliseconds kLook{50};
constexpr size_t kTopicBytes = 65535;

// Types of packets with their flags (MQTT 3.1.1, section 2.2).
constexpr char kConnect = 0x10, kPublishQos1 = 0x32;
constexpr unsigned char kConnack = 0x20, kPuback = 0x40;
constexpr char kPacketId[] = {0, 1};
constexpr char kDisconnect[] = {static_cast<char>(0xE0), 0};

// A text with its length in front (section 1.5.3).
std::string Prefixed(std::string_view text) {
  std::string out{static_cast<char>(text.size() >> 8), static_cast<char>(text.size() & 0xFF)};
  return out.append(text);
}

// A packet with its length (section 2.2.3).
std::string Packet(char type, std::string_view content) {
  std::string out(1, type);
  size_t left = content.size();
  do {
    const char seven_bits = static_cast<char>(left & 0x7F);
    left >>= 7;
    out.push_back(left > 0 ? static_cast<char>(seven_bits | 0x80) : seven_bits);
  } while (left > 0);
  return out.append(content);
}

struct Message {
  const std::string& broker;
  HostAndPort address;
  std::string_view topic, payload;
  std::chrono::milliseconds timeout;
};

absl::Status Failed(const Message& message, const char* doing, const boost::system::error_code& error) {
  const std::string what =
      absl::StrCat("the MQTT broker at ", message.broker, ": ", doing, ": ", error.message());
  return error == boost::beast::error::timeout ? absl::DeadlineExceededError(what)
                                               : absl::UnavailableError(what);
}

net::awaitable<absl::Status> Run(net::io_context& context, const Message& message) {
  boost::system::error_code error;
  tcp::resolver resolver(context);
  const auto addresses =
      co_await resolver.async_resolve(message.address.host, absl::StrCat(message.address.port.value_or(1883)),
                                      net::redirect_error(net::use_awaitable, error));
  if (error) co_return Failed(message, "looking up the host", error);
  boost::beast::tcp_stream stream(context);
  stream.expires_after(message.timeout);
  co_await stream.async_connect(addresses, net::redirect_error(net::use_awaitable, error));
  if (error) co_return Failed(message, "connecting", error);
  // Clean session, no keep-alive, and a client id that the broker chooses (section 3.1).
  const std::string hello =
      Packet(kConnect, Prefixed("MQTT") + std::string("\x04\x02\x00\x00", 4) + Prefixed(""));
  co_await net::async_write(stream, net::buffer(hello), net::redirect_error(net::use_awaitable, error));
  std::array<unsigned char, 4> answer{};
  if (!error)
    co_await net::async_read(stream, net::buffer(answer), net::redirect_error(net::use_awaitable, error));
  if (error) co_return Failed(message, "greeting it", error);
  if (answer[0] != kConnack || answer[1] != 2 || answer[3] != 0) {
    co_return absl::UnavailableError(absl::StrCat("the MQTT broker at ", message.broker,
                                                  " refuses the connection, code ",
                                                  static_cast<int>(answer[3])));
  }
  std::string content = Prefixed(message.topic) + std::string(kPacketId, 2);
  content.append(message.payload);
  const std::string publish = Packet(kPublishQos1, content);
  co_await net::async_write(stream, net::buffer(publish), net::redirect_error(net::use_awaitable, error));
  if (!error)
    co_await net::async_read(stream, net::buffer(answer), net::redirect_error(net::use_awaitable, error));
  if (error) co_return Failed(message, "publishing", error);
  // Section 3.4: of this packet and of no other.
  if (answer[0] != kPuback || answer[1] != 2 || answer[2] != kPacketId[0] || answer[3] != kPacketId[1])
    co_return absl::UnavailableError(
        absl::StrCat("the MQTT broker at ", message.broker, " does not acknowledge the message"));
  co_await net::async_write(stream, net::buffer(kDisconnect), net::redirect_error(net::use_awaitable, error));
  co_return absl::OkStatus();
}

}  // namespace

absl::Status PublishToMqtt(const std::string& broker, std::string_view topic, std::string_view payload,
                           std::chrono::milliseconds timeout, Cancellation* cancellation) {
  const std::optional<HostAndPort> address = SplitHostAndPort(broker);
  if (!address || address->host.empty())
    return absl::InvalidArgumentError(
        absl::StrCat(broker, " is no address of an MQTT broker; write HOST:PORT"));
  if (topic.empty() || topic.size() > kTopicBytes ||
      topic.find_first_of(std::string_view("+#\0", 3)) != std::string_view::npos)
    return absl::InvalidArgumentError("an MQTT topic is 1 to 65535 bytes without +, # and U+0000");
  net::io_context context(1);
  std::optional<absl::Status> status;
  const Message message{broker, *address, topic, payload, timeout};
  net::co_spawn(
      context, [&]() -> net::awaitable<void> { status = co_await Run(context, message); }, net::detached);
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    context.run_for(kLook);
    context.restart();
    if (status) return *status;
    if (absl::Status cancelled = cancellation->CheckNow(); !cancelled.ok()) return cancelled;
    // Looking up a host does not end by itself.
    if (std::chrono::steady_clock::now() >= deadline)
      return absl::DeadlineExceededError(absl::StrCat("the MQTT broker at ", broker, " does not answer"));
  }
}

}  // namespace docent::server
