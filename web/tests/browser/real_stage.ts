// The world of scenario s01 on a real server, with a real robot, in the one browser.
import type { Page } from "playwright-core";
import { expect, vi } from "vitest";
import { type PageOptions, Pages, patienceMs, picture } from "./pages";
import { Processes } from "./processes";

export const expo = "https://w3id.org/docent/expo#";

export class RealStage {
  readonly processes = new Processes();
  pages!: Pages;

  static async open(robot: { speed: number } | null, ...files: string[]): Promise<RealStage> {
    const stage = new RealStage();
    try {
      await stage.processes.startServer();
      stage.processes.load(
        "--as",
        "ontology",
        ...["docent", "place", "robot", "run", "sensor", "service", "time"].map(
          (name) => `ontology/${name}.ttl`,
        ),
      );
      stage.processes.load(
        ...["hall.ttl", "world.ttl", "guide.rules", ...files].map(
          (name) => `scenarios/s01_booth_guide/${name}`,
        ),
      );
      if (robot) stage.processes.startRobot(robot.speed);
      stage.pages = await Pages.open();
    } catch (error) {
      await stage.close();
      throw error;
    }
    return stage;
  }
  async close() {
    await this.pages?.close();
    await this.processes.close();
  }
  page(path: string, options: PageOptions = {}): Promise<Page> {
    return this.pages.page(this.processes.url + path, options);
  }
  picture(page: Page, name: string): Promise<void> {
    return picture(page, `real-${name}`);
  }
  // Waits until it is so: of the server, outside of pages.
  until(what: () => Promise<boolean>): Promise<boolean> {
    return vi.waitUntil(what, { timeout: patienceMs, interval: 100 });
  }
  // John is guided to a booth, from his choice to the end of the run BoothGuide-1. Needs a robot, the services and the workflow.
  async guideJohn(booth: string) {
    const run = () =>
      this.call<{ state: string; nodes: { name: string; state: string }[] }>("Workflows/Get", {
        run: "BoothGuide-1",
      }).catch(() => ({ state: "", nodes: [] }));
    const waits = (node: string) =>
      this.until(async () => (await run()).nodes.some((n) => n.name === node && n.state === "waiting"));
    this.processes.tell("--reading", "expo:DoorSensor=tag-17");
    this.processes.tell("expo:John docent:chose expo:BoothGuideService");
    await waits("Move2Booth");
    this.processes.tell(`expo:John docent:selected ${booth}`);
    await waits("InfoBooth");
    this.processes.tell(`expo:John docent:isAt ${booth}`);
    await this.until(async () => (await run()).state === "done");
  }
  // A call of the API, as a script makes it.
  async call<T>(method: string, request: object = {}): Promise<T> {
    const answer = await fetch(`${this.processes.url}/docent.v1.${method}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(request),
    });
    const body = (await answer.json()) as T & { message?: string };
    if (!answer.ok) throw new Error(`${method}: ${body.message}`);
    return body;
  }
  noFaults() {
    expect(this.pages.faults).toEqual([]);
  }
}
