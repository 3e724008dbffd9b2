// Much of everything: thousands of robots, a flow of thousands of steps, a service description of 10 MB. The views stay usable.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { settled } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";
import { Stage, usualAnswers } from "./stage";

describe("much", () => {
  let stage: Stage;
  beforeAll(async () => {
    stage = await Stage.open();
  });
  afterAll(() => stage.close());

  it("10,000 robots: the hall lists some, says how many there are, and finds the others", async () => {
    const robots = Array.from({ length: 10_000 }, (_, i) => ({
      robot: `urn:robot:${i}`,
      label: `Robot ${i}`,
      state: i % 3 ? "standby" : "busy",
      operations: ["driveTo"],
      hasPose: true,
      xM: (i % 100) / 3,
      yM: Math.floor(i / 100) / 5,
    }));
    stage.answers = { ...usualAnswers(), "Fleet/List": () => ({ robots }) };
    const page = await stage.page("/hall");
    await page.getByText("and 9900 more").waitFor();
    expect(await page.locator(".hall-robot").count()).toBe(1000);
    await page.keyboard.press("Control+k");
    await page.keyboard.type("Robot 742");
    await page.getByRole("option", { name: "Show robot Robot 742" }).waitFor();
    await page.keyboard.press("Enter");
    await page.locator(".properties-head", { hasText: "Robot 742" }).waitFor();
    await stage.picture(page, "large-robots");
    const compose = await stage.page("/compose/BoothGuide");
    await compose.locator(".palette-item", { hasText: "10000 robots" }).waitFor();
  });
  it("5,000 steps: the canvas is drawn, and a step is found by name", async () => {
    stage.answers = usualAnswers();
    const page = await stage.page("/compose");
    const nodes = Array.from(
      { length: 5000 },
      (_, i) => `    <node name="n${i}"><invoke operation="say"/></node>`,
    ).join("\n");
    const links = Array.from({ length: 4999 }, (_, i) => `    <link from="n${i}" to="n${i + 1}"/>`).join(
      "\n",
    );
    await page.evaluate(
      (text) => localStorage.setItem("docent.draft.Big", JSON.stringify({ text, base: "", savedMs: 1 })),
      `<CAWL name="Big">\n  <flow name="F">\n    <source name="s"/>\n${nodes}\n    <sink name="t"/>\n    <link from="s" to="n0"/>\n${links}\n    <link from="n4999" to="t"/>\n  </flow>\n</CAWL>`,
    );
    await page.goto(`${stage.url}/compose/Big`);
    await page.locator(".react-flow__node").first().waitFor();
    await page.keyboard.press("Control+k");
    await page.keyboard.type("step n4321");
    await page.getByRole("option", { name: "Go to step n4321" }).waitFor();
    await page.keyboard.press("Enter");
    await page.locator('.properties-head input[value="n4321"]').waitFor();
    await settled(page);
  });
  it("no page has thrown", () => expect(stage.faults.filter((f) => !/WebSocket/.test(f))).toEqual([]));
});

const why = lacking();
describe.skipIf(why !== "")("a service description of 10 MB", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open(null);
  });
  afterAll(() => stage?.close());
  it("becomes steps, or is refused with its reason, and the view goes on", async () => {
    const description = (name: string, bytes: number) => {
      const operations = Array.from(
        { length: 1000 },
        (_, i) =>
          `<operation name="op${i}"><documentation>${"x".repeat(bytes / 1000 - 100)}</documentation></operation>`,
      ).join("\n");
      const path = join(stage.processes.folder, name);
      writeFileSync(
        path,
        `<definitions xmlns="http://schemas.xmlsoap.org/wsdl/" name="Large" targetNamespace="urn:large"><portType name="P">${operations}</portType></definitions>`,
      );
      return path;
    };
    const page = await stage.page("/compose/New");
    await page.locator(".template").first().click();
    await page.getByRole("button", { name: "Import from WSDL or gRPC" }).click();
    const read = async (button: string, file: string) => {
      const chooser = page.waitForEvent("filechooser");
      await page.getByRole("button", { name: button }).click();
      await (await chooser).setFiles(file);
      await page.getByRole("button", { name: file.split("/").at(-1) ?? "" }).waitFor();
      await page.getByRole("button", { name: "Read it" }).click();
    };
    await read("Choose a file", description("larger.wsdl", 10_500_000));
    await page.locator("dialog .notice.bad").waitFor();
    expect(await page.locator("dialog").evaluate((d) => d.scrollWidth - d.clientWidth)).toBeLessThanOrEqual(
      0,
    );
    await stage.picture(page, "larger-wsdl");
    await read("larger.wsdl", description("large.wsdl", 9_500_000));
    await page.getByRole("button", { name: "Add 1000 to the palette" }).waitFor();
    await stage.picture(page, "large-wsdl");
    await page.getByRole("button", { name: "Add 1000 to the palette" }).click();
    await page.keyboard.press("/");
    await page.keyboard.type("op999");
    await page.getByRole("option", { name: /^Op999/ }).waitFor();
  });
  it("no page has thrown", () => stage.noFaults());
});
