// A browser and a server for tests: the built app under the policy that `docent serve` sends, with an API of fixed answers.
import { createReadStream, existsSync, mkdirSync, readFileSync, statSync } from "node:fs";
import http from "node:http";
import type { AddressInfo } from "node:net";
import { extname, join } from "node:path";
import { type Browser, chromium, type Page } from "playwright-core";

const web = join(import.meta.dirname, "../..");
export const guide = readFileSync(join(web, "../scenarios/s01_booth_guide/booth_guide.cawl.xml"), "utf8");
const types: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".woff2": "font/woff2", ".svg": "image/svg+xml" };

export type Answers = Record<string, (request: Record<string, unknown>) => unknown>;

// Answers of a server with a robot, the services of the booth guide, and one workflow.
export function usualAnswers(): Answers {
  const service = (name: string, ...inputs: string[]) => ({ name, document: "BoothServices", inputs, inputParts: inputs.map((i) => ({ name: i, type: `https://w3id.org/docent#${i === "user" ? "Visitor" : "Booth"}` })) });
  return {
    "Fleet/List": () => ({ robots: [{ robot: "https://w3id.org/docent/expo#R01", label: "R01", state: "standby", operations: ["moveToUser", "moveToBooth", "displayBoothInfo", "briefBoothInfo"], hasPose: true, xM: 9.6, yM: 6.2, headingRad: -3.14 }] }),
    "RobotServices/List": () => ({ services: [service("moveToUser", "user"), service("moveToBooth", "booth"), service("displayInformation", "booth"), service("briefInformation", "booth")] }),
    "Workflows/List": () => ({ workflows: [{ name: "BoothGuide", version: "1.0", flows: ["BoothGuide"], activatedFlow: "BoothGuide" }] }),
    "Workflows/ListVersions": ({ workflow }) => (workflow === "BoothGuide" ? { versions: [{ number: 1, version: "1.0", live: true, text: guide }] } : new Error("not_found")),
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
  return [{
    file: "x", line: before.length, column: [...(before.at(-1) ?? "")].length + 1, message: "the ontology has no docent:isAtt", hint: "did you mean docent:isAt?", warning: true, rule: "unknown-word",
    fix: [{ offset: String(Buffer.byteLength(text.slice(0, at))), length: "12", replacement: "docent:isAt" }],
  }];
}

export class Stage {
  answers: Answers | null = usualAnswers(); // null: the server does not answer
  calls: { method: string; request: Record<string, unknown> }[] = [];
  faults: string[] = []; // what pages wrote to the console as errors, or threw
  private constructor(
    private readonly browser: Browser,
    private readonly server: http.Server,
    readonly url: string,
  ) {}

  static async open(): Promise<Stage> {
    const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
    let stage: Stage | undefined;
    const server = http.createServer((request, response) => stage?.answer(request, response));
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    stage = new Stage(browser, server, `http://127.0.0.1:${(server.address() as AddressInfo).port}`);
    return stage;
  }

  async close() {
    await this.browser.close();
    this.server.closeAllConnections();
    this.server.close();
  }

  async page(path: string, options: { dark?: boolean; width?: number; height?: number } = {}): Promise<Page> {
    const context = await this.browser.newContext({
      viewport: { width: options.width ?? 1280, height: options.height ?? 800 }, colorScheme: options.dark ? "dark" : "light", reducedMotion: "reduce",
      permissions: ["clipboard-read", "clipboard-write"],
    });
    const page = await context.newPage();
    page.on("pageerror", (error) => this.faults.push(error.message));
    page.on("console", (message) => message.type() === "error" && !/Failed to load resource|WebSocket connection/.test(message.text()) && this.faults.push(message.text()));
    await page.goto(this.url + path);
    return page;
  }

  // Keeps a picture for people to look at.
  async picture(page: Page, name: string) {
    mkdirSync(join(web, "test-results"), { recursive: true });
    await page.screenshot({ path: join(web, "test-results", `${name}.png`) });
  }

  private answer(request: http.IncomingMessage, response: http.ServerResponse) {
    const path = new URL(request.url ?? "/", "http://x").pathname;
    if (path.startsWith("/docent.v1.")) return void this.call(path.slice("/docent.v1.".length), request, response);
    const wanted = join(web, "dist", path);
    const file = existsSync(wanted) && statSync(wanted).isFile() ? wanted : join(web, "dist/index.html");
    response.setHeader("Content-Type", types[extname(file)] ?? "application/octet-stream");
    response.setHeader("Content-Security-Policy", "default-src 'none'; script-src 'self' 'nonce-abc'; style-src 'self' 'nonce-abc'; img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'");
    if (file.endsWith(".html")) response.end(readFileSync(file, "utf8").replaceAll("docent-csp-nonce", "abc"));
    else createReadStream(file).pipe(response);
  }

  private async call(method: string, request: http.IncomingMessage, response: http.ServerResponse) {
    const chunks: Buffer[] = [];
    for await (const chunk of request) chunks.push(chunk as Buffer);
    if (!this.answers) return void request.socket.destroy();
    const body = Buffer.concat(chunks);
    const stream = request.headers["content-type"] === "application/connect+json";
    const message = JSON.parse((stream ? body.subarray(5) : body).toString() || "{}") as Record<string, unknown>;
    this.calls.push({ method, request: message });
    const answer = this.answers[method]?.(message) ?? new Error("unimplemented");
    if (!stream) {
      response.statusCode = answer instanceof Error ? (answer.message === "not_found" ? 404 : 501) : 200;
      response.setHeader("Content-Type", "application/json");
      return void response.end(JSON.stringify(answer instanceof Error ? { code: answer.message, message: answer.message } : answer));
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

// The text of the draft that the app has kept, after the moment that it takes to keep it.
export async function draft(page: Page, name: string): Promise<string> {
  await page.waitForTimeout(450);
  return page.evaluate((key) => (JSON.parse(localStorage.getItem(key) ?? '{"text":""}') as { text: string }).text, `docent.draft.${name}`);
}
