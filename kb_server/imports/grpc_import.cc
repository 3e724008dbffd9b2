// Templates of the methods of a gRPC server, by server reflection.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/descriptor_database.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/sync_stream.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/imports/import_channel.h"
#include "kb_server/imports/import_target.h"
#include "kb_server/imports/reflection.pb.h"
#include "kb_server/imports/service_import.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

// One call of ServerReflectionInfo: questions and answers in turn.
class ReflectionCall {
 public:
  ReflectionCall(std::string target, const char* version, const grpc::CallbackServerContext* parent)
      : target_(std::move(target)), channel_(ImportChannel(target_)), context_(ImportContext(parent)) {
    const std::string name =
        absl::StrCat("/grpc.reflection.", version, ".ServerReflection/ServerReflectionInfo");
    method_name_ = name;
    const grpc::internal::RpcMethod method(method_name_.c_str(), grpc::internal::RpcMethod::BIDI_STREAMING,
                                           channel_);
    stream_.reset(
        grpc::internal::ClientReaderWriterFactory<imports::ReflectionRequest,
                                                  imports::ReflectionResponse>::Create(channel_.get(), method,
                                                                                       context_.get()));
  }
  ~ReflectionCall() { context_->TryCancel(); }

  absl::StatusOr<imports::ReflectionResponse> Ask(const imports::ReflectionRequest& request) {
    imports::ReflectionResponse response;
    if (ended_) return absl::UnknownError(absl::StrCat(target_, " has ended the call"));
    if (!stream_->Write(request) || !stream_->Read(&response)) {
      ended_ = true;
      status_ = stream_->Finish();
      if (status_.ok())
        return absl::UnknownError(absl::StrCat(target_, " ended the call of server reflection"));
      return ImportError(target_, status_, "has no server reflection; switch it on there");
    }
    if (response.has_error_response()) {
      const std::string& why = response.error_response().error_message();
      return absl::UnknownError(
          absl::StrCat(target_, " does not describe itself: ", why.substr(0, why.find('\n')).substr(0, 200)));
    }
    return response;
  }
  bool ended() const { return ended_; }
  bool unimplemented() const { return ended_ && status_.error_code() == grpc::StatusCode::UNIMPLEMENTED; }

 private:
  const std::string target_;
  const std::shared_ptr<grpc::Channel> channel_;
  std::string method_name_;
  const std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReaderWriter<imports::ReflectionRequest, imports::ReflectionResponse>> stream_;
  bool ended_ = false;
  grpc::Status status_;
};

// Mistakes of the descriptions are told in one line, not printed.
class FirstError final : public pb::DescriptorPool::ErrorCollector {
 public:
  void AddError(const std::string& file, const std::string& element, const pb::Message*, ErrorLocation,
                const std::string& message) override {
    if (text_.empty()) text_ = absl::StrCat(file, ": ", element, ": ", message.substr(0, message.find('\n')));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// The descriptions of all files that the services need.
class Descriptions {
 public:
  // Of the services that the server describes; the names of the others go to `unknown`.
  absl::Status Fetch(const std::string& target, const std::vector<std::string>& services,
                     ReflectionCall* call, std::set<std::string>* unknown) {
    for (const std::string& service : services) {
      imports::ReflectionRequest request;
      request.set_file_containing_symbol(service);
      const absl::StatusOr<imports::ReflectionResponse> response = call->Ask(request);
      if (!response.ok() && !call->ended()) {
        unknown->insert(service);
        continue;
      }
      if (absl::Status status = Take(target, response); !status.ok()) return status;
    }
    while (!wanted_.empty()) {
      const std::string file = *wanted_.begin();
      wanted_.erase(wanted_.begin());
      if (files_.contains(file)) continue;
      imports::ReflectionRequest request;
      request.set_file_by_filename(file);
      if (absl::Status status = Take(target, call->Ask(request)); !status.ok()) return status;
      if (!files_.contains(file))
        return absl::UnknownError(absl::StrCat(target, " does not give the description ", file));
    }
    for (const auto& [name, file] : files_) database_.Add(file);
    return absl::OkStatus();
  }

  pb::DescriptorDatabase* database() { return &database_; }

 private:
  absl::Status Take(const std::string& target, const absl::StatusOr<imports::ReflectionResponse>& response) {
    if (!response.ok()) return response.status();
    for (const std::string& bytes : response->file_descriptor_response().file_descriptor_proto()) {
      pb::FileDescriptorProto file;
      if (!file.ParseFromString(bytes))
        return absl::UnknownError(absl::StrCat(target, " gives a description that does not decode"));
      bytes_ += bytes.size();
      if (files_.size() >= kWorkflowLimits.import_files || bytes_ > kWorkflowLimits.import_bytes) {
        return absl::ResourceExhaustedError(
            absl::StrCat("the descriptions of ", target, " are over the limits import_files ",
                         kWorkflowLimits.import_files, " or import_bytes ", kWorkflowLimits.import_bytes));
      }
      for (const std::string& dependency : file.dependency()) {
        if (!files_.contains(dependency)) wanted_.insert(dependency);
      }
      const std::string name = file.name();
      files_.emplace(name, std::move(file));
    }
    return absl::OkStatus();
  }

  std::map<std::string, pb::FileDescriptorProto> files_;
  std::set<std::string> wanted_;
  size_t bytes_ = 0;
  pb::SimpleDescriptorDatabase database_;
};

// The datatype of XML Schema of a field's values; empty: another message.
std::string TypeOf(const pb::FieldDescriptor& field) {
  const auto xsd = [](const char* local) { return Concat(kXsdNs, local); };
  switch (field.cpp_type()) {
    case pb::FieldDescriptor::CPPTYPE_INT32:
      return xsd("int");
    case pb::FieldDescriptor::CPPTYPE_INT64:
      return xsd("long");
    case pb::FieldDescriptor::CPPTYPE_UINT32:
      return xsd("unsignedInt");
    case pb::FieldDescriptor::CPPTYPE_UINT64:
      return xsd("unsignedLong");
    case pb::FieldDescriptor::CPPTYPE_DOUBLE:
      return xsd("double");
    case pb::FieldDescriptor::CPPTYPE_FLOAT:
      return xsd("float");
    case pb::FieldDescriptor::CPPTYPE_BOOL:
      return xsd("boolean");
    case pb::FieldDescriptor::CPPTYPE_ENUM:
      return xsd("string");
    case pb::FieldDescriptor::CPPTYPE_STRING:
      return field.type() == pb::FieldDescriptor::TYPE_BYTES ? xsd("base64Binary") : xsd("string");
    case pb::FieldDescriptor::CPPTYPE_MESSAGE:
      if (field.message_type()->full_name() == "google.protobuf.Timestamp") return xsd("dateTime");
      if (field.message_type()->full_name() == "google.protobuf.Duration") return xsd("dayTimeDuration");
      return "";
  }
  return "";
}

class MethodReader {
 public:
  MethodReader(std::string target, templates::ImportedTemplates* out)
      : target_(std::move(target)), out_(*out) {}

  // False: there are enough.
  bool Add(const pb::MethodDescriptor& method) {
    if (out_.templates.size() >= kWorkflowLimits.import_templates) {
      Warn(absl::StrCat("there are more methods; the limit import_templates is ",
                        kWorkflowLimits.import_templates),
           "");
      return false;
    }
    if (method.client_streaming() || method.server_streaming()) {
      Warn(absl::StrCat("method ", method.full_name(), " streams"),
           "it is left out: a node invokes and waits for one answer");
      return true;
    }
    templates::NodeTemplate one;
    one.operation = method.name();
    one.service = method.service()->full_name();
    one.endpoint = target_;
    AddFields(method, *method.input_type(), &one.inputs);
    AddFields(method, *method.output_type(), &one.outputs);
    out_.templates.push_back(std::move(one));
    return true;
  }

 private:
  void AddFields(const pb::MethodDescriptor& method, const pb::Descriptor& message,
                 std::vector<templates::TemplatePart>* parts) {
    for (int i = 0; i < message.field_count(); ++i) {
      const pb::FieldDescriptor& field = *message.field(i);
      if (field.is_repeated()) {
        Warn(absl::StrCat("field ", field.name(), " of ", method.full_name(), " repeats"),
             "a node gives one value for it");
      }
      if (AddPart(field.name(), field.is_map() ? "" : TypeOf(field), parts)) continue;
      Warn(absl::StrCat(message.full_name(), " has too many fields"),
           "those after the limit import_parts are left out");
      return;
    }
  }
  void Warn(std::string message, std::string hint) {
    constexpr size_t kMostDiagnostics = 200;
    if (out_.diagnostics.size() >= kMostDiagnostics) return;
    out_.diagnostics.push_back(
        {target_, {}, std::move(message), std::move(hint), Diagnostic::Severity::kWarning});
  }

  const std::string target_;
  templates::ImportedTemplates& out_;
};

absl::StatusOr<templates::ImportedTemplates> Import(const std::string& target, ReflectionCall* call) {
  imports::ReflectionRequest list;
  list.set_list_services("*");
  const absl::StatusOr<imports::ReflectionResponse> listed = call->Ask(list);
  if (!listed.ok()) return listed.status();
  std::vector<std::string> services;
  for (const imports::Service& service : listed->list_services_response().service()) {
    if (!absl::StartsWith(service.name(), "grpc.reflection.") &&
        services.size() < kWorkflowLimits.import_templates)
      services.push_back(service.name());
  }
  std::sort(services.begin(), services.end());
  Descriptions descriptions;
  std::set<std::string> unknown;
  if (absl::Status status = descriptions.Fetch(target, services, call, &unknown); !status.ok()) return status;
  FirstError error;
  pb::DescriptorPool pool(descriptions.database(), &error);
  templates::ImportedTemplates out;
  MethodReader reader(target, &out);
  for (const std::string& name : services) {
    if (unknown.contains(name)) {
      out.diagnostics.push_back({target,
                                 {},
                                 absl::StrCat("service ", name, " is listed and not described"),
                                 "it is left out",
                                 Diagnostic::Severity::kWarning});
      continue;
    }
    const pb::ServiceDescriptor* service = pool.FindServiceByName(name);
    if (service == nullptr) {
      return absl::UnknownError(absl::StrCat(
          "the descriptions of ", target,
          " do not fit together: ", error.text().empty() ? "there is no service " + name : error.text()));
    }
    for (int i = 0; i < service->method_count(); ++i) {
      if (!reader.Add(*service->method(i))) break;
    }
  }
  WriteCawl(&out.templates);
  return out;
}

}  // namespace

absl::StatusOr<templates::ImportedTemplates> ImportFromGrpc(const std::string& target,
                                                            const grpc::CallbackServerContext* parent) {
  if (absl::Status status = CheckTarget(target); !status.ok()) return status;
  ReflectionCall older(target, "v1alpha", parent);
  absl::StatusOr<templates::ImportedTemplates> out = Import(target, &older);
  if (out.ok() || !older.unimplemented()) return out;
  ReflectionCall newer(target, "v1", parent);
  return Import(target, &newer);
}

}  // namespace docent::server
