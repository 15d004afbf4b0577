// Bundles of a cell's black box: the bytes "GBB" and 1, then the message.
import { fromBinary } from "@bufbuild/protobuf";
import { BundleSchema, type Bundle } from "../../gen/graspdb/v1/bundle_pb";

const head = [0x47, 0x42, 0x42];  // GBB
const version = 1;

export function readBundle(bytes: Uint8Array): Bundle {
  if (bytes.length < 4 || head.some((byte, i) => bytes[i] !== byte)) throw new Error("it is not a bundle of a black box");
  if (bytes[3] !== version) throw new Error("it was written by a newer version");
  let bundle: Bundle;
  try {
    bundle = fromBinary(BundleSchema, bytes.subarray(4));
  } catch {
    throw new Error("it is truncated or damaged");
  }
  if (!bundle.request || bundle.result.case === undefined) throw new Error("it is truncated or damaged");
  return bundle;
}
