// The server, through the console's own address.
import { create, type DescMessage, type DescMethodStreaming, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";
import { Code, ConnectError, createClient, type Interceptor } from "@connectrpc/connect";
import { createConnectTransport } from "@connectrpc/connect-web";
import { CatalogService, type UploadViewsRequestSchema, type UploadViewsResponse } from "../../gen/graspdb/v1/catalog_service_pb";
import { CellService } from "../../gen/graspdb/v1/cell_service_pb";
import { ObjectHistoryService } from "../../gen/graspdb/v1/object_history_service_pb";
import { RecognitionService } from "../../gen/graspdb/v1/recognition_service_pb";
import { UploadService, type WriteUploadViewsRequestSchema } from "../../gen/graspdb/v1/upload_service_pb";
import type { Status } from "../../gen/google/rpc/status_pb";
import { ViewDetail, type Object$ as CatalogObject, type StablePose, type View } from "../../gen/graspdb/v1/catalog_pb";
import type { Cell } from "../../gen/graspdb/v1/cell_pb";
import { BadRequestSchema, ErrorInfoSchema } from "../../gen/google/rpc/error_details_pb";
import { codes, reasons } from "../../gen/errors";

// In memory only: neither a cookie nor the browser's storage has it.
let token = "";
export function setToken(text: string): void {
  token = text.trim();
}

const withToken: Interceptor = (next) => (request) => {
  if (token !== "") request.header.set("Authorization", `Bearer ${token}`);
  return next(request);
};

const transport = createConnectTransport({
  baseUrl: location.origin, useBinaryFormat: true, interceptors: [withToken], defaultTimeoutMs: 60_000,
});

export const catalog = createClient(CatalogService, transport);
export const cells = createClient(CellService, transport);
export const objectHistory = createClient(ObjectHistoryService, transport);
export const uploads = createClient(UploadService, transport);
export const recognition = createClient(RecognitionService, transport);

// A call of a method that takes a stream of requests, with one of them. The library has no such calls, since browsers cannot
// send bodies that go on; a body with one message is that of a method with a stream of responses.
async function callWithOne<I extends DescMessage, O extends DescMessage>(
  method: DescMethodStreaming<I, O>, request: MessageInitShape<I>, signal?: AbortSignal,
): Promise<MessageShape<O>> {
  async function* one(): AsyncGenerator<MessageInitShape<I>> {
    yield create(method.input, request);
  }
  const asStream = { ...method, methodKind: "server_streaming" as const };
  const response = await transport.stream(asStream, signal, undefined, undefined, one());
  let last: MessageShape<O> | undefined;
  for await (const message of response.message) last = message;
  if (!last) throw new ConnectError("the server sent no response", Code.Internal);
  return last;
}

// Teaches one view, which is durable then.
export const uploadView = (request: MessageInitShape<typeof UploadViewsRequestSchema>): Promise<UploadViewsResponse> =>
  callWithOne(CatalogService.method.uploadViews, request);

// The error that a message has, as one that a call ends with.
function errorOf(status: Status): ConnectError {
  const out = new ConnectError(status.message, status.code as Code);
  out.details = status.details.map((each) => ({ type: each.typeUrl.slice(each.typeUrl.lastIndexOf("/") + 1), value: each.value }));
  return out;
}

// Sends one view to a bulk upload. Throws where it cannot be taught, too.
export async function writeUploadView(request: MessageInitShape<typeof WriteUploadViewsRequestSchema>, signal: AbortSignal): Promise<void> {
  const { error } = await callWithOne(UploadService.method.writeUploadViews, request, signal);
  if (error) throw errorOf(error);
}

async function allPages<R extends { nextPageToken: string }, T>(
  page: (pageToken: string) => Promise<R>, records: (response: R) => T[], most: number,
): Promise<T[]> {
  const out: T[] = [];
  let pageToken = "";
  do {
    const response = await page(pageToken);
    out.push(...records(response));
    pageToken = response.nextPageToken;
  } while (pageToken !== "" && out.length < most);
  return out.slice(0, most);
}

export const listObjects = (most: number): Promise<CatalogObject[]> =>
  allPages((pageToken) => catalog.listObjects({ pageToken, pageSize: 1000 }), (page) => page.objects, most);
export const listDeletedObjects = (most: number): Promise<CatalogObject[]> =>
  allPages((pageToken) => objectHistory.listDeletedObjects({ pageToken, pageSize: 1000 }), (page) => page.objects, most);
export const listStablePoses = (parent: string, most: number): Promise<StablePose[]> =>
  allPages((pageToken) => catalog.listStablePoses({ parent, pageToken }), (page) => page.stablePoses, most);
export const listViews = (parent: string, most: number): Promise<View[]> =>
  allPages((pageToken) => catalog.listViews({ parent, pageToken, pageSize: Math.min(most, 1000) }), (page) => page.views, most);
export const listCells = (most: number): Promise<Cell[]> =>
  allPages((pageToken) => cells.listCells({ pageToken }), (page) => page.cells, most);

// Views never change. The most recent ones are kept.
const keptViews = new Map<string, Promise<View>>();
const maxKeptViews = 200;
export function fullView(name: string): Promise<View> {
  const kept = keptViews.get(name);
  if (kept) return kept;
  const view = catalog.getView({ name, detail: ViewDetail.FULL });
  view.catch(() => keptViews.delete(name));
  keptViews.set(name, view);
  if (keptViews.size > maxKeptViews) keptViews.delete(keptViews.keys().next().value as string);
  return view;
}

export const describedView = (name: string): Promise<View> => catalog.getView({ name, detail: ViewDetail.DESCRIBED });

export interface Explained { title: string; text: string; advice: string; requestId: string; needsToken: boolean }

// An error with the advice of docs/errors.md. `title`: of one that the page itself made.
export function explain(error: unknown, title = ""): Explained {
  if (title !== "" && error instanceof Error && error.constructor === Error) {
    return { title, text: error.message, advice: "", requestId: "", needsToken: false };
  }
  const e = ConnectError.from(error);
  const name = Code[e.code].replace(/([a-z])([A-Z])/g, "$1_$2").toUpperCase().replace(/^CANCELED$/, "CANCELLED");
  const reason = e.findDetails(ErrorInfoSchema)[0]?.reason ?? "";
  const fields = e.findDetails(BadRequestSchema).flatMap((detail) => detail.fieldViolations);
  return {
    title: reason !== "" && reason !== name ? `${name}, ${reason}` : name,
    text: [e.rawMessage, ...fields.map((each) => `${each.field}: ${each.description}`).filter((each) => !e.rawMessage.includes(each))].join("\n"),
    advice: (reasons[reason] ?? codes[name])?.action ?? "",
    requestId: e.metadata.get("x-request-id") ?? "",
    needsToken: e.code === Code.Unauthenticated || e.code === Code.PermissionDenied,
  };
}
