#include "client/eval/report/evidence_json.h"

#include "client/files/json_object.h"

namespace graspdb::client {

void FillEvidence(const recognition::Evidence& evidence, const recognition::Doubt& doubt,
                  google::protobuf::Value* value) {
  JsonObject out(value);
  out.Number("scan_explained", evidence.scan_explained);
  out.Number("model_seen", evidence.model_seen);
  out.Number("in_sight", evidence.in_sight);
  out.Number("rms_mm", evidence.rms_m * 1e3);
  out.Number("score", evidence.score);
  out.Number("confirmed", evidence.confirmed);
  out.Number("contradicted", evidence.contradicted);
  out.Number("unmeasured", evidence.unmeasured);
  JsonObject doubts(&out.At("doubt"));
  doubts.Number("scan", doubt.scan);
  doubts.Number("contradicted", doubt.contradicted);
  doubts.Number("residual", doubt.residual);
  doubts.Number("unseen", doubt.unseen);
  doubts.Number("little", doubt.little);
}

}  // namespace graspdb::client
