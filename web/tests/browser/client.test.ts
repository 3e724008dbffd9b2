// The client package against a real server: its example in Node, as a stranger runs it, and what it makes of the API.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { connectDocent, docentTerm, fact, literal, namespace } from "../../client/src/index";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const example = join(import.meta.dirname, "../../client/dist/example/guide.js");
const why = lacking() || (existsSync(example) ? "" : `${example} is not built`);
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the client", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open(null, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    await stage.processes.startAdapter(
      `${expo}R01`,
      ["moveToUser:user", "moveToBooth:booth", "displayBoothInfo:booth", "briefBoothInfo:booth"],
      "--take-ms",
      "100",
      "--fact",
      `isAt=${expo}B05`,
      "--fact",
      "status=https://w3id.org/docent#Standby",
    );
    stage.processes.tell("expo:R01 docent:localised true");
  });
  afterAll(() => stage?.close());

  it("runs its example to the end of the guide", async () => {
    const flags = "WebSocket" in globalThis ? [] : ["--experimental-websocket"]; // Node 20
    const node = spawn(process.execPath, [...flags, example, stage.processes.url, "B05"], {
      stdio: ["ignore", "pipe", "pipe"],
    });
    let text = "";
    let errors = "";
    node.stdout.on("data", (chunk: Buffer) => (text += chunk.toString()));
    node.stderr.on("data", (chunk: Buffer) => (errors += chunk.toString()));
    const code = await new Promise((done) => node.once("exit", done));
    expect([code, code === 0 ? "" : errors]).toEqual([0, ""]);
    expect(text).toMatch(/R01 is (standby|busy)/);
    expect(text).toMatch(
      /BoothGuide-1 Move2User: running[\s\S]*BoothGuide-1 InfoBooth: done[\s\S]*BoothGuide-1 : done/,
    );
    expect(text.trim().split("\n").at(-1)).toBe(`robots: ${expo}R01`);
  });

  it("tells, selects, asks, and says what the server refuses", async () => {
    const docent = connectDocent(stage.processes.url);
    const name = namespace(expo);
    const told = fact(name("Sign"), docentTerm("comment"), literal('a "sign" <b>', "", "de"));
    const first = await docent.tell([told], { source: `${expo}Desk`, requestId: "once" });
    expect(await docent.tell([told], { source: `${expo}Desk`, requestId: "once" })).toMatchObject({
      repeated: true,
      offset: first.offset,
    });
    const rows = await docent.select(
      `SELECT ?text ?none { <${expo}Sign> <https://w3id.org/docent#comment> ?text OPTIONAL { ?text <urn:x> ?none } }`,
    );
    expect(rows).toMatchObject([{ text: { kind: "literal", text: 'a "sign" <b>', language: "de" } }]);
    expect(rows[0]?.["none"]).toBeUndefined();
    expect(await docent.ask(`ASK { <${expo}Sign> ?p ?o }`)).toBe(true);
    await expect(docent.select("SELECT nothing")).rejects.toThrow(/1:8: error/);
    expect((await docent.fleet.list({})).robots.map((r) => r.robot)).toEqual([`${expo}R01`]);
    const counts: number[] = [];
    const stop =
      "WebSocket" in globalThis
        ? docent.watch(`SELECT ?open { <${expo}Sign> <https://w3id.org/docent#openNow> ?open }`, (rows) =>
            counts.push(rows.length),
          )
        : undefined;
    if (stop) await stage.until(async () => counts.at(-1) === 0);
    await docent.tell([fact(name("Sign"), docentTerm("openNow"), true)], { source: `${expo}Desk` });
    expect(await docent.ask(`ASK { <${expo}Sign> <https://w3id.org/docent#openNow> true }`)).toBe(true);
    if (stop) await stage.until(async () => counts.at(-1) === 1);
    stop?.();
    await docent.tell([], {
      source: `${expo}Desk`,
      remove: [told, fact(name("Sign"), docentTerm("openNow"), true)],
    });
    expect(await docent.ask(`ASK { <${expo}Sign> ?p ?o }`)).toBe(false);
  });
});
