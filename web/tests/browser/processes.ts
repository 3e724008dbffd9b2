// A real server and a real robot for tests of the whole way. They listen on loopback, on free ports, and end with the test.
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const tree = join(import.meta.dirname, "../../..");
const binaries = process.env["DOCENT_BINARIES"] ?? join(tree, "build/dev/bin");

// Why the whole way can't be tested here; empty: it can.
export function lacking(): string {
  for (const program of ["docent", "docent-robot", "docent-scripted-adapter"])
    if (!existsSync(join(binaries, program))) return `${join(binaries, program)} is not built`;
  return execFileSync(join(binaries, "docent"), ["serve", "--help"], { encoding: "utf8" }).includes("--web")
    ? ""
    : "this docent serves no app";
}

export class Processes {
  readonly folder = mkdtempSync(join(tmpdir(), "docent-web-test-"));
  private server: ChildProcess | undefined;
  private robot: ChildProcess | undefined;
  private readonly adapters: ChildProcess[] = [];
  grpc = "127.0.0.1:0";
  http = "127.0.0.1:0";

  async startServer() {
    this.server = spawn(
      join(binaries, "docent"),
      [
        "serve",
        "--data",
        join(this.folder, "data"),
        "--grpc",
        this.grpc,
        "--http",
        this.http,
        "--web",
        join(tree, "web/dist"),
      ],
      { stdio: ["ignore", "pipe", "inherit"] },
    );
    const line = await firstLine(this.server);
    this.grpc = /grpc=(\S+)/.exec(line)?.[1] ?? "";
    this.http = /http=(\S+)/.exec(line)?.[1] ?? "";
  }
  // `screen` is its address from then on.
  screen: Promise<string> = Promise.resolve("");
  startRobot(speed: number) {
    this.robot = spawn(
      join(binaries, "docent-robot"),
      ["--server", this.grpc, "--out", join(this.folder, "robot"), "--speed", String(speed)],
      { stdio: ["ignore", "pipe", "ignore"] },
    );
    this.screen = firstLine(this.robot).then(
      (line) => /screen=(\S+)/.exec(line)?.[1] ?? "",
      () => "",
    );
  }
  // Robots whose operations take their time and do nothing; `options` as of docent-scripted-adapter. Resolves when it listens.
  async startAdapter(robot: string, operations: readonly string[], ...options: string[]): Promise<string> {
    const adapter = spawn(
      join(binaries, "docent-scripted-adapter"),
      ["--server", this.grpc, "--robot", robot, ...operations.flatMap((o) => ["--operation", o]), ...options],
      { stdio: ["ignore", "pipe", "ignore"] },
    );
    this.adapters.push(adapter);
    return /grpc=(\S+)/.exec(await firstLine(adapter))?.[1] ?? "";
  }
  docent(command: string, ...rest: string[]): string {
    return execFileSync(join(binaries, "docent"), [command, "--server", this.grpc, ...rest], {
      cwd: tree,
      encoding: "utf8",
      stdio: ["ignore", "pipe", "pipe"],
    });
  }
  // The same beside the test; resolves with its exit code.
  aside(command: string, ...rest: string[]): Promise<number | null> {
    const process = spawn(join(binaries, "docent"), [command, "--server", this.grpc, ...rest], {
      cwd: tree,
      stdio: "ignore",
    });
    return new Promise((done) => process.once("exit", done));
  }
  // A command that needs no server.
  docentAlone(...what: string[]): string {
    return execFileSync(join(binaries, "docent"), what, { encoding: "utf8" });
  }
  load(...what: string[]) {
    this.docent("load", ...what);
  }
  tell(...what: string[]) {
    this.docent("tell", "--prefix", "expo=https://w3id.org/docent/expo#", ...what);
  }
  get url(): string {
    return `http://${this.http}`;
  }
  // Without a chance to tidy up.
  async killServer() {
    const ended = new Promise((resolve) => this.server?.once("exit", resolve));
    this.server?.kill("SIGKILL");
    await ended;
  }
  async close() {
    for (const process of [this.robot, ...this.adapters, this.server]) {
      if (!process || process.exitCode !== null || process.signalCode !== null) continue;
      const ended = new Promise((resolve) => process.once("exit", resolve));
      process.kill("SIGTERM");
      const hard = setTimeout(() => process.kill("SIGKILL"), 8000);
      await ended;
      clearTimeout(hard);
    }
    rmSync(this.folder, { recursive: true, force: true });
  }
}

function firstLine(process: ChildProcess): Promise<string> {
  return new Promise((resolve, reject) => {
    let text = "";
    process.stdout?.on("data", (chunk: Buffer) => {
      text += chunk.toString();
      if (text.includes("\n")) resolve(text.split("\n")[0] ?? "");
    });
    process.once("exit", (code) => reject(new Error(`the server ended with ${code}`)));
  });
}
