#include "kb_server/grpc/version_proto.h"

namespace docent::server {

void ToProto(const DocumentVersions& versions, bool with_texts, v1::ListVersionsReply* out) {
  for (const DocumentVersionPtr& version : versions.kept) {
    v1::DeployedVersion* to = out->add_versions();
    to->set_number(version->number);
    to->set_version(version->own_version);
    to->set_revision(version->revision.value());
    to->set_time_us(version->time_us);
    to->set_live(versions.live && version == versions.kept.back());
    if (with_texts) to->set_text(version->text);
  }
}

}  // namespace docent::server
