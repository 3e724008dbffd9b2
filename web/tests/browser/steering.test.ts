// Deploying another version with its differences, steering runs, settling incidents, and importing steps, against a real server
// and robots that do as the test wants.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { draft, dragOnto } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

const errand = `<?xml version="1.0" encoding="UTF-8"?>
<!-- fetches something that can't be fetched, and brings it -->
<CAWL name="Errand" namespace="https://w3id.org/docent/expo#" version="1.0" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Errand">
    <source name="Begin"/>
    <node name="Fetch" ext:onFailure="incident"><invoke operation="fetch"/></node>
    <node name="Bring"><invoke operation="bring"/></node>
    <sink name="End"/>
    <link from="Begin" to="Fetch"/>
    <link from="Fetch" to="Bring"/>
    <link from="Bring" to="End"/>
  </flow>
</CAWL>
`;
const wsdl = `<definitions xmlns="http://schemas.xmlsoap.org/wsdl/" xmlns:xsd="http://www.w3.org/2001/XMLSchema" xmlns:t="urn:shop" targetNamespace="urn:shop" name="Shop">
  <message name="Ask"><part name="article" type="xsd:string"/><part name="count" type="xsd:integer"/></message>
  <message name="Answer"><part name="price" type="xsd:decimal"/></message>
  <portType name="ShopPort"><operation name="askPrice"><documentation>Tells a &lt;b&gt;price&lt;/b&gt;.</documentation><input message="t:Ask"/><output message="t:Answer"/></operation></portType>
</definitions>`;

describe.skipIf(why !== "")("steering, with a real server and robots", () => {
  let stage: RealStage;
  let adapter = "";
  beforeAll(async () => {
    stage = await RealStage.open(null);
    const standby = ["--fact", "status=https://w3id.org/docent#Standby"];
    adapter = await stage.processes.startAdapter(
      `${expo}R10`,
      ["fetch"],
      "--take-ms",
      "200",
      "--fail",
      ...standby,
    );
    await stage.processes.startAdapter(`${expo}R11`, ["bring"], "--take-ms", "15000", ...standby);
    const file = join(stage.processes.folder, "errand.cawl.xml");
    writeFileSync(file, errand);
    stage.processes.load(file);
  });
  afterAll(() => stage?.close());
  const state = (page: Page, words: string) => page.locator(".head .tag", { hasText: words });
  async function begin(): Promise<Page> {
    const page = await stage.page("/compose/Errand");
    await page.getByRole("button", { name: "Run", exact: true }).click();
    await page.locator("dialog").getByRole("button", { name: "Start" }).click();
    await page.waitForURL(/\/runs\/.+/);
    await state(page, "needs you").waitFor();
    return page;
  }

  it("an incident is tried again, counted as done; the run is paused, goes on and is done", async () => {
    const page = await begin();
    await stage.picture(page, "steering-incident");
    const since = await page.locator(".run-section .small.number").first().innerText();
    expect(since).toContain("for ");
    await page.getByRole("button", { name: "Try again" }).click();
    await page.locator(".toast.good", { hasText: "The step begins again" }).waitFor();
    await state(page, "needs you").waitFor();
    await page.getByRole("button", { name: "Count as done" }).click();
    await page.locator('.react-flow__node[data-id="Bring"] .state-chip.running').waitFor();
    await page.keyboard.press("Shift+P");
    await page.locator("dialog").getByText("R11 still does Bring.").waitFor();
    await page.locator("dialog").getByRole("button", { name: "Let it finish" }).click();
    await state(page, "paused").waitFor();
    await stage.picture(page, "steering-paused");
    await page.getByRole("button", { name: "Go on" }).click();
    await state(page, "done").waitFor();
    await page.getByRole("tab", { name: "History" }).click();
    for (const words of ["needs you", "paused", "done"])
      await page.locator(".timeline li", { hasText: words }).first().waitFor();
    await stage.picture(page, "steering-history");
  });

  it("a pause can stop the robot: also later, while it still ends its step", async () => {
    const page = await begin();
    await page.getByRole("button", { name: "Count as done" }).click();
    await page.locator('.react-flow__node[data-id="Bring"] .state-chip.running').waitFor();
    await page.getByRole("button", { name: "Pause", exact: true }).click();
    await page.locator("dialog").getByRole("button", { name: "Stop it now" }).click();
    // It must not be repeated unasked: somebody decides.
    await page
      .getByText("bring was cancelled since its run was paused, and it must not be repeated unasked")
      .waitFor();
    await page.getByRole("button", { name: "Go on" }).waitFor();
    await page.locator(".stale", { hasText: "still does" }).waitFor({ state: "detached" });
    await stage.picture(page, "steering-stopped");
    await page.getByRole("button", { name: "Cancel", exact: true }).click();
    await page.getByRole("button", { name: "Cancel the run" }).click();
    await state(page, "cancelled").waitFor();
  });

  it("before a deployment it is said how many runs would start at once", async () => {
    const text = errand
      .replaceAll("Errand", "Greeting")
      .replace(
        "  <flow name",
        '  <activator name="OnWish"><activate flow="Greeting"/><condition><context name="Wish"><rule name="wish"><constraint name="wish"><subject>?user</subject><verb>docent:chose</verb><object>?service</object></constraint></rule></context></condition></activator>\n  <flow name',
      )
      .replace("xmlns:ext", 'xmlns:docent="https://w3id.org/docent#" xmlns:ext');
    for (const who of ["Ann", "Ben", "Cai"]) stage.processes.tell(`expo:${who} docent:chose expo:Greeting`);
    const page = await stage.page("/compose/Greeting", {
      script: `if (!localStorage.getItem("docent.draft.Greeting")) localStorage.setItem("docent.draft.Greeting", ${JSON.stringify(JSON.stringify({ text, savedMs: 1, base: "" }))})`,
    });
    await page.getByRole("button", { name: "Deploy" }).first().click();
    await page.locator("dialog .notice", { hasText: "3 fit now: Deploy starts 3 runs at once." }).waitFor();
    await stage.picture(page, "steering-starts-now");
  });

  it("an incident is let fail, and the run says why", async () => {
    const page = await begin();
    await page.getByRole("button", { name: "Let it fail" }).click();
    await state(page, "failed").waitFor();
    await page.locator(".stale", { hasText: "failed as the test wanted" }).waitFor();
  });

  it("a run is cancelled with its reason; the board offers the same as the run's page", async () => {
    const page = await begin();
    const id = decodeURIComponent(new URL(page.url()).pathname.split("/")[2] ?? "");
    const board = await stage.page("/board");
    const row = board.locator("li", { hasText: id });
    await row.getByRole("button", { name: "Try again" }).waitFor();
    await stage.picture(board, "steering-board");
    await row.hover();
    await row.getByRole("button", { name: "Cancel" }).click();
    await board.getByLabel("Reason").fill("nobody wants <it>");
    await board.getByRole("button", { name: "Cancel the run" }).click();
    await board.locator(".toast.good", { hasText: "cancelled" }).waitFor();
    await row.waitFor({ state: "detached" });
    await state(page, "cancelled").waitFor();
    await page.locator(".stale", { hasText: "nobody wants <it>" }).waitFor();
  });

  it("another version is deployed with its differences; the run of the one before goes on with its own", async () => {
    const old = await begin();
    const page = await stage.page("/compose/Errand?step=Bring");
    await page.locator('.properties-head input[aria-label="Name"]').fill("Deliver");
    await page.keyboard.press("Enter");
    await draft(page, "Errand").toContain('<node name="Deliver">');
    await page.getByRole("button", { name: "Deploy" }).first().click();
    const dialog = page.locator("dialog");
    await dialog.locator(".deploy-steps .new", { hasText: "Errand / Deliver" }).waitFor();
    await dialog.locator(".deploy-steps .gone", { hasText: "Errand / Bring" }).waitFor();
    await dialog
      .locator(".deploy-flow .react-flow__node", { hasText: "Deliver" })
      .locator(".state-chip.diff-new")
      .waitFor();
    await dialog
      .locator(".deploy-flow .react-flow__node", { hasText: "Bring" })
      .locator(".state-chip.diff-gone")
      .waitFor();
    expect(await dialog.locator(".deploy-flow .state-chip").count()).toBe(2);
    expect(await dialog.locator(".deploy-diff .new").allInnerTexts()).toEqual([
      expect.stringContaining('<node name="Deliver">'),
      expect.stringContaining('<link from="Fetch" to="Deliver"/>'),
      expect.stringContaining('<link from="Deliver" to="End"/>'),
    ]);
    const height = (await dialog.boundingBox())?.height;
    expect(await dialog.locator('input[aria-label="Version"]').inputValue()).toBe("1.1"); // one higher is proposed
    await dialog.locator('input[aria-label="Version"]').fill("2.0");
    await page.keyboard.press("Tab");
    expect((await dialog.boundingBox())?.height).toBe(height);
    await stage.picture(page, "steering-deploy");
    await dialog.getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "Errand is deployed" }).waitFor();
    const { versions } = await stage.call<{
      versions: { number: number; version: string; live?: boolean; text?: string }[];
    }>("Workflows/ListVersions", { workflow: "Errand", withTexts: true });
    expect(versions.map((v) => [v.number, v.version, v.live ?? false])).toEqual([
      [1, "1.0", false],
      [2, "2.0", true],
    ]);
    expect(versions[0]?.text).toBe(errand);
    expect(versions[1]?.text).toBe(
      errand.replace(/"Bring"/g, '"Deliver"').replace('version="1.0" xmlns', 'version="2.0" xmlns'),
    );
    await old.reload();
    await old.locator('.react-flow__node[data-id="Bring"]').waitFor(); // its own text, not the newest one
    await old.getByRole("button", { name: "Count as done" }).click();
    await state(old, "done").waitFor();
    const list = await stage.page("/compose");
    await list.locator(".document", { hasText: "version 2.0" }).waitFor();
  });

  it("steps are imported from a WSDL text and file, a gRPC server and an adapter; what is wrong is said", async () => {
    const page = await stage.page("/compose/Errand");
    const imports = () => page.getByRole("button", { name: "Import from WSDL or gRPC" }).click();
    const dialog = page.locator("dialog");
    await imports();
    await dialog.getByLabel("Text of the WSDL").fill("<definitions>");
    await dialog.getByRole("button", { name: "Read it" }).click();
    await dialog.getByRole("alert").waitFor();
    await dialog.getByLabel("Text of the WSDL").fill(wsdl);
    await dialog.getByRole("button", { name: "Read it" }).click();
    await dialog.getByText("takes article, count").waitFor();
    expect(await dialog.getByRole("alert").count()).toBe(0);
    await stage.picture(page, "steering-import");
    await dialog.getByRole("button", { name: "Add 1 to the palette" }).click();
    await page.locator(".palette-item", { hasText: "Ask price" }).waitFor();
    await imports();
    const chooser = page.waitForEvent("filechooser");
    await dialog.getByRole("button", { name: "Choose a file" }).click();
    await (
      await chooser
    ).setFiles({
      name: "shop.wsdl",
      mimeType: "text/xml",
      buffer: Buffer.from(wsdl.replaceAll("askPrice", "sellThing")),
    });
    await dialog.getByRole("button", { name: "shop.wsdl" }).waitFor();
    await dialog.getByRole("button", { name: "Read it" }).click();
    await dialog.getByRole("button", { name: "Add 1 to the palette" }).click();
    await page.locator(".palette-item", { hasText: "Sell thing" }).waitFor();
    for (const [from, address, finds] of [
      ["gRPC server", stage.processes.grpc, /Add \d+ to the palette/],
      ["adapter", adapter, /Add 1 to the palette/],
    ] as const) {
      await imports();
      await dialog.getByRole("radio", { name: new RegExp(from, "i") }).click();
      await dialog.getByLabel("Address").fill("127.0.0.1:1");
      await page.keyboard.press("Enter");
      await dialog.getByRole("alert").waitFor();
      await dialog.getByLabel("Address").fill(address);
      await page.keyboard.press("Enter");
      await dialog.getByRole("button", { name: finds }).click();
    }
    await dragOnto(page, page.locator(".palette-item", { hasText: "Ask price" }), "Begin → Fetch");
    await page.locator('.react-flow__node[data-id="Ask price"]').waitFor();
    await draft(page, "Errand").toContain('<invoke operation="askPrice"/>');
    await draft(page, "Errand").toContain("<!-- fetches something that can't be fetched, and brings it -->");
  });

  it("no page has thrown", () => stage.noFaults());
});
