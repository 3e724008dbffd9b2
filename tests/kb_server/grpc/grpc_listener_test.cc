#include "kb_server/grpc/grpc_listener.h"
#include "spdlog/spdlog.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

// A connection that sends nothing.
class SilentClient {
 public:
  explicit SilentClient(uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  SilentClient(const SilentClient&) = delete;
  SilentClient& operator=(const SilentClient&) = delete;
  ~SilentClient() { close(fd_); }
  bool connected() const { return connected_; }
  // True if the server closes it within `wait_ms`.
  bool Ended(int wait_ms) const {
    const absl::Time end = absl::Now() + absl::Milliseconds(wait_ms);
    char bytes[1024];
    while (true) {
      pollfd waited{fd_, POLLIN, 0};
      if (poll(&waited, 1, static_cast<int>(absl::ToInt64Milliseconds(end - absl::Now()))) <= 0) return false;
      if (recv(fd_, bytes, sizeof(bytes), MSG_DONTWAIT) <= 0) return true;
    }
  }

 private:
  const int fd_;
  bool connected_ = false;
};

// A gRPC server with its health service alone.
class GrpcListenerTest : public ::testing::Test {
 protected:
  void Start(size_t connections) {
    auto listener = GrpcListener::Listen("127.0.0.1:0", connections);
    ASSERT_TRUE(listener.ok()) << listener.status();
    listener_ = *std::move(listener);
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    listener_->AddTo(&builder);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    server_->GetHealthCheckService()->SetServingStatus("", true);
    listener_->Start();
  }
  void TearDown() override {
    if (listener_) listener_->Stop();
    if (server_) server_->Shutdown(std::chrono::system_clock::now());
  }
  std::shared_ptr<grpc::Channel> Connect() {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    auto channel = grpc::CreateCustomChannel(absl::StrCat("127.0.0.1:", listener_->port()),
                                             grpc::InsecureChannelCredentials(), arguments);
    return channel;
  }
  static bool Answers(const std::shared_ptr<grpc::Channel>& channel) {
    return channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(60));
  }

  std::unique_ptr<GrpcListener> listener_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(GrpcListenerTest, ConnectionsAreServedAndCounted) {
  Start(10);
  auto channel = Connect();
  ASSERT_TRUE(Answers(channel));
  EXPECT_EQ(listener_->open(), 1u);
  EXPECT_EQ(listener_->accepted(), 1u);
  EXPECT_TRUE(listener_->status().ok());
  channel.reset();
  for (int i = 0; i < 6000 && listener_->open() > 0; ++i) absl::SleepFor(absl::Milliseconds(10));
  EXPECT_EQ(listener_->open(), 0u);
}

TEST_F(GrpcListenerTest, IdleConnectionsMakeRoomForOthers) {
  Start(4);
  std::vector<std::unique_ptr<SilentClient>> silent;
  for (int i = 0; i < 20; ++i) {
    silent.push_back(std::make_unique<SilentClient>(listener_->port()));
    ASSERT_TRUE(silent.back()->connected());
  }
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(Answers(Connect()));
  EXPECT_TRUE(silent[0]->Ended(60000));
  EXPECT_GE(listener_->closed_idle(), 5u);
  for (int i = 0; i < 6000 && listener_->open() > 4; ++i) absl::SleepFor(absl::Milliseconds(10));
  EXPECT_LE(listener_->open(), 4u);
}

TEST_F(GrpcListenerTest, ConnectionsWithACallAreKept) {
  Start(2);
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::GenericClientAsyncReaderWriter>> calls;
  grpc::CompletionQueue queue;
  for (int i = 0; i < 2; ++i) {
    channels.push_back(Connect());
    ASSERT_TRUE(Answers(channels.back()));
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    calls.push_back(grpc::GenericStub(channels.back())
                        .PrepareCall(contexts.back().get(), "/grpc.health.v1.Health/Watch", &queue));
    calls.back()->StartCall(nullptr);
    void* tag;
    bool ok = false;
    ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  }
  for (int i = 0; i < 6000 && PeerPortsWithCalls().size() < 2; ++i) absl::SleepFor(absl::Milliseconds(10));
  SilentClient third(listener_->port());
  EXPECT_TRUE(third.Ended(60000)) << "there is no room for it";
  EXPECT_EQ(listener_->refused(), 1u);
  EXPECT_EQ(channels[0]->GetState(false), GRPC_CHANNEL_READY);
  EXPECT_EQ(channels[1]->GetState(false), GRPC_CHANNEL_READY);
  for (auto& context : contexts) context->TryCancel();
  for (auto& call : calls) {
    grpc::Status status;
    call->Finish(&status, nullptr);
    void* tag;
    bool ok;
    queue.Next(&tag, &ok);
  }
}

// All that are free. By system calls: the thread sanitizer follows descriptors, but does not see that gRPC closes them.
void TakeDescriptors(std::vector<int>* taken) {
  for (long fd = syscall(SYS_dup, 0); fd >= 0; fd = syscall(SYS_dup, 0))
    taken->push_back(static_cast<int>(fd));
}

// As if other code used all descriptors: nothing is accepted, an error is logged, and accepting goes on when
// some are free.
TEST_F(GrpcListenerTest, AcceptingGoesOnAfterDescriptorsHaveRunOut) {
  Start(1000);
  ASSERT_TRUE(Answers(Connect()));
  spdlog::error("the next errors of the listener are expected");  // UBSan reads a type once, by a descriptor
  std::vector<int> taken;
  rlimit before;
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit low = before;
  low.rlim_cur = 200;
  setrlimit(RLIMIT_NOFILE, &low);
  SilentClient client(listener_->port());  // has its descriptor, and waits to be accepted or is
  std::vector<std::unique_ptr<SilentClient>> more;
  TakeDescriptors(&taken);
  for (int i = 0; i < 3 && !taken.empty(); ++i) {
    syscall(SYS_close, taken.back());
    taken.pop_back();
    more.push_back(std::make_unique<SilentClient>(listener_->port()));
    TakeDescriptors(&taken);
  }
  for (int i = 0; i < 6000 && listener_->status().ok(); ++i) absl::SleepFor(absl::Milliseconds(10));
  const std::string said(listener_->status().message());
  for (const int fd : taken) syscall(SYS_close, fd);
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_THAT(said, HasSubstr("accepts nothing at the moment: Too many open files"));
  EXPECT_TRUE(Answers(Connect()));
  EXPECT_TRUE(listener_->status().ok());
}

TEST(GrpcListener, AddressesThatCannotBeListenedOnAreNamed) {
  auto first = GrpcListener::Listen("127.0.0.1:0", 1);
  ASSERT_TRUE(first.ok());
  const std::string address = absl::StrCat("127.0.0.1:", (*first)->port());
  EXPECT_THAT(std::string(GrpcListener::Listen(address, 1).status().message()),
              HasSubstr(absl::StrCat("cannot listen on ", address, " for gRPC: Address already in use")));
  EXPECT_THAT(std::string(GrpcListener::Listen("no host.invalid:1", 1).status().message()),
              HasSubstr("cannot listen on no host.invalid:1"));
  EXPECT_FALSE(GrpcListener::Listen("nothing", 1).ok());
  EXPECT_TRUE(GrpcListener::Listen("localhost:0", 1).ok());
}

}  // namespace
}  // namespace docent::server
