// A visitor chooses the booth guide and a booth; the robots and the steps of the run are followed until it has ended.
//   npm run build && node dist/example/guide.js http://127.0.0.1:7480 B05      (Node 22 or newer, which has WebSocket)
import {
  connectDocent,
  docentTerm,
  fact,
  iri,
  ListRobotsReplySchema,
  ListRobotsRequestSchema,
  namespace,
  RunEventSchema,
  WatchRequestSchema,
} from "../src/index.js";

const expo = namespace("https://w3id.org/docent/expo#");

export async function guide(address: string, booth: string, say: (line: string) => void): Promise<void> {
  const docent = connectDocent(address);
  const visitor = iri(`urn:uuid:${crypto.randomUUID()}`);
  const stopRobots = docent.follow({
    call: "docent.v1.Fleet/List",
    input: ListRobotsRequestSchema,
    output: ListRobotsReplySchema,
    everyMs: 1000,
    onMessage: ({ robots }) => say(robots.map((r) => `${r.label || r.robot} is ${r.state}`).join(", ")),
  });
  await new Promise<void>((done) => {
    let told = false;
    const stop = docent.follow({
      call: "docent.v1.Workflows/Watch",
      input: WatchRequestSchema,
      output: RunEventSchema,
      onBegun: () => {
        if (told) return;
        told = true;
        void docent.tell([
          fact(visitor, iri("http://www.w3.org/1999/02/22-rdf-syntax-ns#type"), docentTerm("Visitor")),
          fact(visitor, iri("http://www.w3.org/2000/01/rdf-schema#label"), "a visitor"),
          fact(visitor, docentTerm("isAt"), expo(booth)),
          fact(visitor, docentTerm("selected"), expo(booth)),
          fact(visitor, docentTerm("chose"), expo("BoothGuideService")),
        ]);
      },
      onMessage: (event) => {
        say(`${event.run} ${event.node}: ${event.to}`);
        if (event.kind !== "run" || !["done", "failed", "cancelled"].includes(event.to)) return;
        stop();
        done();
      },
    });
  });
  stopRobots();
  const rows = await docent.select(
    "PREFIX docent: <https://w3id.org/docent#> SELECT ?robot { ?robot a docent:Robot }",
  );
  say(`robots: ${rows.map((row) => row["robot"]?.text).join(" ")}`);
}

const [, script, address = "http://127.0.0.1:7480", booth = "B05"] = globalThis.process?.argv ?? [];
if (script?.endsWith("guide.js"))
  guide(address, booth, console.log).then(
    () => process.exit(0),
    (error: unknown) => (console.error(error), process.exit(1)),
  );
