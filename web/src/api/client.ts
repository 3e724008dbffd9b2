// Clients of the server's services, over the Connect protocol on the address that the app came from.
import { createClient, type Interceptor } from "@connectrpc/connect";
import { createConnectTransport } from "@connectrpc/connect-web";
import { Context } from "../gen/docent/v1/context_pb";
import { Fleet } from "../gen/docent/v1/fleet_pb";
import { Ontologies } from "../gen/docent/v1/ontologies_pb";
import { Replays } from "../gen/docent/v1/replays_pb";
import { RobotServices } from "../gen/docent/v1/robot_services_pb";
import { Workflows } from "../gen/docent/v1/workflows_pb";
import { plain } from "./errors";
import { serverAnswered, serverSilent } from "./connection";

// Tells the badge whether the server is there.
const watch: Interceptor = (next) => async (request) => {
  try {
    const answer = await next(request);
    serverAnswered();
    return answer;
  } catch (error) {
    const { kind } = plain(error);
    if (kind === "away") serverSilent();
    else if (kind !== "cancelled") serverAnswered();
    throw error;
  }
};

const baseUrl = globalThis.location?.origin ?? ""; // there is none in tests of parts
const transport = createConnectTransport({ baseUrl, interceptors: [watch], defaultTimeoutMs: 30_000 });
// Without a deadline: for streams that stay open.
const streamTransport = createConnectTransport({ baseUrl, interceptors: [watch] });

export const workflows = createClient(Workflows, transport);
export const fleet = createClient(Fleet, transport);
export const services = createClient(RobotServices, transport);
export const context = createClient(Context, transport);
export const replays = createClient(
  Replays,
  createConnectTransport({ baseUrl, interceptors: [watch], defaultTimeoutMs: 120_000 }),
); // a past state is made again from the log
export const ontologies = createClient(Ontologies, transport);
export const workflowStreams = createClient(Workflows, streamTransport);
