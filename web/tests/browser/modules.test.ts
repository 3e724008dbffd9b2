// A workflow that is reused in another one is opened in place, and a way leads back.
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { guide, Stage, usualAnswers } from "./stage";

const johns = `<?xml version="1.0" encoding="UTF-8"?>
<CAWL name="John's Service" version="1.0" xmlns:docent="https://w3id.org/docent#">
  <flow name="Visit">
    <variable name="user" type="docent:Visitor"/>
    <source name="Begin"/>
    <node name="Guide &amp; go"><invoke subflow="BoothGuide"/></node>
    <node name="Farewell"><invoke subflow="Goodbye"/></node>
    <sink name="End"/>
    <link from="Begin" to="Guide &amp; go"/>
    <link from="Guide &amp; go" to="Farewell"/>
    <link from="Farewell" to="End"/>
  </flow>
  <flow name="Goodbye"><source name="B"/><node name="Wave"/><sink name="E"/><link from="B" to="Wave"/><link from="Wave" to="E"/></flow>
</CAWL>
`;

describe("modules", () => {
  let stage: Stage;
  beforeAll(async () => {
    stage = await Stage.open();
    const usual = usualAnswers();
    stage.answers = {
      ...usual,
      "Workflows/List": () => ({
        workflows: [
          { name: "BoothGuide", version: "1.0", flows: ["BoothGuide"] },
          { name: "John's Service", flows: ["Visit", "Goodbye"] },
        ],
      }),
      "Workflows/ListVersions": ({ workflow }) =>
        workflow === "BoothGuide"
          ? { versions: [{ number: 1, live: true, text: guide }] }
          : workflow === "John's Service"
            ? { versions: [{ number: 1, live: true, text: johns }] }
            : new Error("not_found"),
    };
  });
  afterAll(() => stage.close());
  const path = "/compose/John's%20Service?flow=Visit";

  it("a module is opened in place, and the crumb leads back to its step", async () => {
    const page = await stage.page(path);
    await page.locator(".react-flow__node", { hasText: "Guide & go" }).dblclick();
    await page.waitForURL(/\/compose\/BoothGuide\?via=/);
    await page.locator('.react-flow__node[data-id="Move2Booth"]').click();
    await page.getByRole("navigation", { name: "Opened from" }).getByText("John's Service / Visit").waitFor();
    await stage.picture(page, "module");
    expect(await seriousFindings(page)).toEqual([]);
    await page.reload();
    await page.getByRole("link", { name: "John's Service / Visit" }).click();
    await page.locator(".react-flow__node.selected", { hasText: "Guide & go" }).waitFor();
    expect(await page.locator(".crumbs").count()).toBe(0);
    await page.goBack();
    await page.locator(".crumbs").waitFor();
  });
  it("by keys: O opens a flow of the same document, U leads back", async () => {
    const page = await stage.page(`${path}&step=Farewell`);
    await page.locator(".react-flow__node.selected", { hasText: "Farewell" }).waitFor();
    await page.keyboard.press("o");
    await page.locator(".react-flow__node", { hasText: "Wave" }).waitFor();
    expect(await page.locator(".react-flow__node.selected").count()).toBe(0);
    await page.keyboard.press("u");
    await page.locator(".react-flow__node.selected", { hasText: "Farewell" }).waitFor();
  });
  it("a way that the app has not made is no mistake", async () => {
    const page = await stage.page("/compose/BoothGuide?via=%25zz%7C%2F%2F");
    await page.locator('.react-flow__node[data-id="Move2Booth"]').waitFor();
    expect(await page.locator(".crumbs").count()).toBe(0);
  });
  it("no page has thrown", () => expect(stage.faults.filter((f) => !/WebSocket/.test(f))).toEqual([]));
});
