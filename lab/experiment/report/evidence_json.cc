#include "lab/experiment/report/evidence_json.h"

#include "files/json_object.h"

namespace graspdb::client {

void FillEvidence(const recognition::Evidence& evidence,
                  const recognition::ConfidenceFeatures& features, google::protobuf::Value* value) {
  JsonObject out(value);
  out.Number("scan_explained", evidence.scan_explained);
  out.Number("model_seen", evidence.model_seen);
  out.Number("in_sight", evidence.unoccluded);
  out.Number("rms_mm", evidence.rms_m * 1e3);
  out.Number("score", evidence.score);
  out.Number("confirmed", evidence.confirmed);
  out.Number("contradicted", evidence.contradicted);
  out.Number("unmeasured", evidence.unmeasured);
  JsonObject json(&out.At("features"));
  json.Number("scan", features.scan);
  json.Number("contradicted", features.contradicted);
  json.Number("residual", features.residual);
  json.Number("unseen", features.unseen);
  json.Number("little", features.little);
}

}  // namespace graspdb::client
