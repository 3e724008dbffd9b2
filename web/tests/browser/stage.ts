// A browser and a server for tests: the built app under the policy that `docent serve` sends, with an API of fixed answers.
import { createReadStream, existsSync, readFileSync, statSync } from "node:fs";
import http from "node:http";
import type { AddressInfo } from "node:net";
import { extname, join } from "node:path";
import type { Page } from "playwright-core";
import { type PageOptions, Pages, picture } from "./pages";

const web = join(import.meta.dirname, "../..");
export const guide = readFileSync(join(web, "../scenarios/s01_booth_guide/booth_guide.cawl.xml"), "utf8");
const types: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".woff2": "font/woff2",
  ".svg": "image/svg+xml",
  ".webmanifest": "application/manifest+json",
  ".png": "image/png",
};

export type Answers = Record<string, (request: Record<string, unknown>) => unknown>;

// Answers of a server with a robot, the services of the booth guide, and one workflow.
export function usualAnswers(): Answers {
  const service = (name: string, ...inputs: string[]) => ({
    name,
    document: "BoothServices",
    inputs,
    inputParts: inputs.map((i) => ({
      name: i,
      type: `https://w3id.org/docent#${i === "user" ? "Visitor" : "Booth"}`,
    })),
  });
  return {
    "Fleet/List": () => ({
      robots: [
        {
          robot: "https://w3id.org/docent/expo#R01",
          label: "R01",
          state: "standby",
          operations: ["moveToUser", "moveToBooth", "displayBoothInfo", "briefBoothInfo"],
          hasPose: true,
          xM: 9.6,
          yM: 6.2,
          headingRad: -3.14,
        },
      ],
    }),
    "RobotServices/List": () => ({
      services: [
        service("moveToUser", "user"),
        service("moveToBooth", "booth"),
        service("displayInformation", "booth"),
        service("briefInformation", "booth"),
      ],
    }),
    "Workflows/List": () => ({
      workflows: [{ name: "BoothGuide", version: "1.0", flows: ["BoothGuide"], activatedFlow: "BoothGuide" }],
    }),
    "Workflows/ListVersions": ({ workflow }) =>
      workflow === "BoothGuide"
        ? { versions: [{ number: 1, version: "1.0", live: true, text: guide }] }
        : new Error("not_found"),
    "Workflows/Check": ({ cawl }) => ({ diagnostics: misspelt(String(cawl)) }),
    "Workflows/Deploy": () => ({ workflow: "Greeter", revision: "17" }),
    "Workflows/ListRuns": () => ({ runs: [] }),
    "Context/Query": () => [{ header: { variables: [] } }],
    "Context/Explain": () => ({}),
  };
}

// As the server's check of words: a verb that the ontology does not have, with its remedy in bytes.
function misspelt(text: string) {
  const at = text.indexOf("docent:isAtt");
  if (at < 0) return [];
  const before = text.slice(0, at).split("\n");
  return [
    {
      file: "x",
      line: before.length,
      column: [...(before.at(-1) ?? "")].length + 1,
      message: "the ontology has no docent:isAtt",
      hint: "did you mean docent:isAt?",
      warning: true,
      rule: "unknown-word",
      fix: [
        { offset: String(Buffer.byteLength(text.slice(0, at))), length: "12", replacement: "docent:isAt" },
      ],
    },
  ];
}

export class Stage {
  answers: Answers | null = usualAnswers(); // null: the server does not answer
  calls: { method: string; request: Record<string, unknown> }[] = [];
  private constructor(
    private readonly pages: Pages,
    private readonly server: http.Server,
    readonly url: string,
  ) {}

  static async open(): Promise<Stage> {
    const pages = await Pages.open();
    const server = http.createServer();
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    const stage = new Stage(pages, server, `http://127.0.0.1:${(server.address() as AddressInfo).port}`);
    server.on("request", (request, response) => stage.answer(request, response));
    return stage;
  }
  async close() {
    await this.pages.close();
    this.server.closeAllConnections();
    this.server.close();
  }
  get faults(): string[] {
    return this.pages.faults;
  }
  page(path: string, options: PageOptions = {}): Promise<Page> {
    return this.pages.page(this.url + path, options);
  }
  picture = picture;

  private answer(request: http.IncomingMessage, response: http.ServerResponse) {
    const path = new URL(request.url ?? "/", "http://x").pathname;
    if (path.startsWith("/docent.v1."))
      return void this.call(path.slice("/docent.v1.".length), request, response);
    const wanted = join(web, "dist", path.replace(/\/$/, ""));
    const file =
      [wanted, `${wanted}.html`].find((name) => existsSync(name) && statSync(name).isFile()) ??
      join(web, "dist/index.html");
    response.setHeader("Content-Type", types[extname(file)] ?? "application/octet-stream");
    response.setHeader(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'self' 'nonce-abc'; style-src 'self' 'nonce-abc'; img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; manifest-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    );
    if (file.endsWith(".html"))
      response.end(readFileSync(file, "utf8").replaceAll("docent-csp-nonce", "abc"));
    else createReadStream(file).pipe(response);
  }

  private async call(method: string, request: http.IncomingMessage, response: http.ServerResponse) {
    const chunks: Buffer[] = [];
    for await (const chunk of request) chunks.push(chunk as Buffer);
    if (!this.answers) return void request.socket.destroy();
    const body = Buffer.concat(chunks);
    const stream = request.headers["content-type"] === "application/connect+json";
    const message = JSON.parse((stream ? body.subarray(5) : body).toString() || "{}") as Record<
      string,
      unknown
    >;
    this.calls.push({ method, request: message });
    const answer = this.answers[method]?.(message) ?? new Error("unimplemented");
    if (!stream) {
      response.statusCode = answer instanceof Error ? (answer.message === "not_found" ? 404 : 501) : 200;
      response.setHeader("Content-Type", "application/json");
      return void response.end(
        JSON.stringify(answer instanceof Error ? { code: answer.message, message: answer.message } : answer),
      );
    }
    response.setHeader("Content-Type", "application/connect+json");
    for (const one of Array.isArray(answer) ? answer : []) response.write(envelope(one, 0));
    response.end(envelope(answer instanceof Error ? { error: { code: answer.message } } : {}, 2));
  }
}

function envelope(message: unknown, flags: number): Buffer {
  const body = Buffer.from(JSON.stringify(message));
  const head = Buffer.alloc(5);
  head[0] = flags;
  head.writeUInt32BE(body.length, 1);
  return Buffer.concat([head, body]);
}
