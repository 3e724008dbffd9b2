// The visitors' page, with a real server and robot: from the code at a booth to the robot's arrival and what the visitor says
// of it; without a network; why no robot comes; in other languages.
import jsQR from "jsqr";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { fitsTheWindow, patienceMs, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);
const phone = { width: 390, height: 780 };

describe.skipIf(why !== "")("a visitor's phone", () => {
  let stage: RealStage;
  beforeAll(
    async () =>
      void (stage = await RealStage.open(
        { speed: 4 },
        "languages.ttl",
        "booth_guide.rsel.xml",
        "booth_guide.cawl.xml",
      )),
  );
  afterAll(() => stage?.close());
  const open = (path: string, options = {}) => stage.page(path, { ...phone, ...options });
  const rows = async (select: string) => {
    const answer = await fetch(`${stage.processes.url}/sparql`, {
      method: "POST",
      headers: { Accept: "application/sparql-results+json" },
      body: new URLSearchParams({ query: `PREFIX docent: <https://w3id.org/docent#> ${select}` }),
    });
    return ((await answer.json()) as { results: { bindings: Record<string, { value: string }>[] } }).results
      .bindings;
  };
  // The robot works for the visitor. How far it has come when the page hears of it is the robot's own time.
  const underWay = (page: Page) =>
    page.locator(".visit-status:is(.coming, .here, .guiding, .ahead)").waitFor();
  const visitorOf = (page: Page) =>
    page.evaluate(
      () => (JSON.parse(localStorage.getItem("docent.visit") ?? "{}") as { id?: string }).id ?? "",
    );
  const call = async (page: Page, booth: string) => {
    await page.getByRole("button", { name: /Booth guide/ }).click();
    await page.getByRole("searchbox").fill(booth);
    await page.locator(".visit-card", { hasText: booth }).first().click();
    await page.getByRole("button", { name: "Call the robot" }).click();
  };

  // What a phone's camera reads in a picture.
  const scan = async (svg: string) => {
    const page = await open("/visit");
    const { data, width, height } = await page.evaluate(async (text) => {
      const image = new Image();
      image.src = `data:image/svg+xml;base64,${btoa(text)}`;
      await image.decode();
      const canvas = Object.assign(document.createElement("canvas"), {
        width: 160,
        height: Math.round((160 * image.height) / image.width),
      });
      const context = canvas.getContext("2d");
      context?.drawImage(image, 0, 0, canvas.width, canvas.height);
      return {
        data: [...(context?.getImageData(0, 0, canvas.width, canvas.height).data ?? [])],
        width: canvas.width,
        height: canvas.height,
      };
    }, svg);
    await page.close();
    return jsQR(new Uint8ClampedArray(data), width, height)?.data ?? "";
  };

  it("the codes of the command line and of the server lead to the page", async () => {
    expect(
      await scan(
        stage.processes.docentAlone("visit", "qr", "--booth", "expo:B07", "--url", stage.processes.url),
      ),
    ).toBe(`${stage.processes.url}/visit?at=expo:B07`);
    const hall = await stage.page("/hall?at=expo:B05");
    const address = await hall.getByRole("link", { name: "Code for visitors" }).getAttribute("href");
    const code = await fetch(stage.processes.url + address);
    expect(code.headers.get("content-type")).toBe("image/svg+xml");
    expect(await scan(await code.text())).toBe(`${stage.processes.url}/visit?at=expo:B05`);
  });

  it("from the code at a booth to the robot's arrival, the tour and the feedback", async () => {
    const page = await open(
      new URL(
        await scan(
          stage.processes.docentAlone("visit", "qr", "--booth", "B07", "--url", stage.processes.url),
        ),
      ).pathname + "?at=B07",
    );
    await page.getByText("You are at B07").waitFor();
    await stage.picture(page, "visit-services");
    await page.getByRole("button", { name: /Booth guide/ }).click();
    await page.getByRole("button", { name: "Map" }).click();
    await stage.picture(page, "visit-map");
    await page.locator('.visit-shape.booth[aria-label^="B05,"]').click();
    await stage.picture(page, "visit-summary");
    await page.getByRole("button", { name: "Call the robot" }).click();
    await page.locator(".visit-status.coming").waitFor();
    await page.locator(".visit-eta").waitFor();
    expect(await page.locator(".visit-eta").innerText()).toMatch(
      /There in (about \d+ min|less than a minute) · \d+ m to go/,
    );
    await stage.picture(page, "visit-coming");
    await page.locator(".visit-status.guiding").waitFor();
    await stage.picture(page, "visit-guiding");
    const id = await visitorOf(page);
    // What is said from here on, in its order: nothing is presented before the visitor is there.
    await page.evaluate(() => {
      const seen: string[] = ((window as { seen?: string[] }).seen = []);
      new MutationObserver(() => {
        const phase = document.querySelector(".visit-status")?.className.replace("visit-status ", "") ?? "";
        if (phase !== seen.at(-1)) seen.push(phase);
      }).observe(document.body, { subtree: true, childList: true, attributes: true });
    });
    expect(await rows(`SELECT ?r { <${id}> docent:isAt <${expo}B07> . ?r a docent:Robot }`)).toHaveLength(1);
    // The visitor has followed the robot, and scans the code there.
    await page.getByText("R01 waits for you at B05").waitFor();
    await page.getByText("Come to B05").waitFor();
    await stage.picture(page, "visit-follow");
    expect(await page.evaluate(() => (window as { seen?: string[] }).seen)).not.toContain("presenting");
    await page.goto(`${stage.processes.url}/visit?at=B05`);
    await page.locator(".visit-status.presenting").waitFor();
    await stage.picture(page, "visit-presenting");
    await page.locator(".visit-status.done").waitFor();
    // It is over: the wish is no longer told, whatever the visitor does with the page.
    await expect
      .poll(() => rows(`SELECT ?x { <${id}> docent:chose|docent:selected ?x }`), { timeout: patienceMs })
      .toEqual([]);
    await page.getByLabel("4 of 5").check({ force: true });
    await page.getByLabel("What should we know").fill('It spoke "clearly", <b>but fast</b>.');
    await stage.picture(page, "visit-feedback");
    await page.getByRole("button", { name: "Send" }).click();
    await page.locator(".visit-thanks").waitFor();
    await expect
      .poll(
        () =>
          rows(
            `SELECT ?stars ?text ?run { ?f a docent:Feedback ; docent:rating ?stars ; docent:comment ?text ; docent:feedbackOn ?run ; docent:givenBy <${id}> }`,
          ),
        { timeout: patienceMs },
      )
      .toEqual([
        {
          stars: expect.objectContaining({ value: "4" }),
          text: expect.objectContaining({ value: 'It spoke "clearly", <b>but fast</b>.' }),
          run: expect.objectContaining({ value: expect.stringMatching(/^urn:docent:run:BoothGuide-/) }),
        },
      ]);
    await page.getByRole("button", { name: "Choose something else" }).click();
    await page.getByRole("button", { name: /Booth guide/ }).waitFor();
  });

  it("a wish lasts as long as its page: a page that was left withdraws it when it is opened again and the run has ended; a second touch ends nothing", async () => {
    const page = await open("/visit?at=B07");
    const told: { lifetimeMs?: string; add?: { predicate: { iri: string } }[] }[] = [];
    page.on(
      "request",
      (request) =>
        void (
          request.url().endsWith("Context/Assert") &&
          told.push(request.postDataJSON() as (typeof told)[number])
        ),
    );
    await page.getByRole("button", { name: /Booth guide/ }).click();
    await page.locator(".visit-card", { hasText: "B05" }).first().click();
    await page.getByRole("button", { name: "Call the robot" }).dblclick();
    await underWay(page);
    expect(await page.locator(".visit-ask").count()).toBe(0);
    expect(
      told.filter((t) => t.add?.some((q) => q.predicate.iri.endsWith("#chose"))).map((t) => t.lifetimeMs),
    ).toEqual(["1800000"]);
    const id = await visitorOf(page);
    // A page that is loaded again without a network says what it knew.
    await page.evaluate(() => navigator.serviceWorker.ready);
    await expect
      .poll(() => page.evaluate(() => localStorage.getItem("docent.visit.last") ?? ""), {
        timeout: patienceMs,
      })
      .toContain("running");
    await page.context().setOffline(true);
    await page.reload();
    await page.locator(".visit-away").waitFor();
    await underWay(page);
    await stage.picture(page, "visit-offline-coming");
    await page.context().setOffline(false);
    await page.goto("about:blank");
    const { runs } = await stage.call<{ runs: { id: string }[] }>("Workflows/ListRuns", { liveOnly: true });
    for (const run of runs) await stage.call("Workflows/Cancel", { run: run.id, reason: "the hall closes" });
    expect(await rows(`SELECT ?x { <${id}> docent:chose ?x }`)).toHaveLength(1); // until its time is over
    await page.goto(`${stage.processes.url}/visit`);
    await page.locator(".visit-status.cancelled").waitFor();
    await expect
      .poll(() => rows(`SELECT ?x { <${id}> docent:chose|docent:selected ?x }`), { timeout: patienceMs })
      .toEqual([]);
    await page.getByRole("button", { name: "Choose something else" }).click();
    await page.getByRole("button", { name: /Booth guide/ }).waitFor();
  });

  it("says in plain words why no robot comes, and who is before", async () => {
    await stage.call("Fleet/TakeOutOfService", { robot: `${expo}R01`, reason: "a wheel squeaks" });
    const first = await open("/visit?at=B03");
    await call(first, "B10");
    await first.getByText("R01 is out of service: a wheel squeaks.").waitFor();
    await stage.picture(first, "visit-out-of-service");
    const second = await open("/visit?at=Entrance", { language: "de-DE" });
    await second.getByText("Sie sind hier: Eingang").waitFor();
    await second.getByText("Ein Roboter kommt zu Ihnen").waitFor();
    await second.getByRole("button", { name: /Standführung/ }).click();
    await second.locator(".visit-card", { hasText: "B01" }).first().click();
    await second.getByRole("button", { name: "Roboter rufen" }).click();
    await second.getByText("R01 ist außer Betrieb: a wheel squeaks.").waitFor();
    await second.getByText("Ein Besucher ist vor Ihnen dran").waitFor();
    await stage.picture(second, "visit-german");
    await second.getByRole("button", { name: "Dienst beenden" }).click();
    await second.getByRole("button", { name: "Beenden", exact: true }).click();
    await second.getByRole("button", { name: /Standführung/ }).waitFor();
    await stage.call("Fleet/PutInService", { robot: `${expo}R01` });
    await underWay(first);
    await first.getByRole("button", { name: "End the service" }).click();
    await first.getByRole("button", { name: "End it" }).click();
    await first.getByRole("button", { name: /Booth guide/ }).waitFor();
    await expect
      .poll(() => stage.call<{ runs?: object[] }>("Workflows/ListRuns", { liveOnly: true }), {
        timeout: patienceMs,
      })
      .toEqual({});
  });

  it("opens without a network from what is kept, says so, and sends the wish when it is back", async () => {
    const page = await open("/visit?at=B07", { language: "ko-KR" });
    await page.getByText("현재 위치: B07").waitFor();
    await stage.picture(page, "visit-korean");
    await page.evaluate(() => navigator.serviceWorker.ready);
    await expect
      .poll(
        () => page.evaluate(async () => (await caches.keys()).some((name) => name.startsWith("visit-"))),
        { timeout: patienceMs },
      )
      .toBe(true);
    await page.getByRole("button", { name: /부스 안내/ }).waitFor();
    await page.context().setOffline(true);
    await page.reload();
    await page.locator(".visit-away").waitFor();
    await page.getByRole("button", { name: /부스 안내/ }).click();
    await page.locator(".visit-card", { hasText: "B06" }).first().click();
    await page.getByRole("button", { name: "로봇 부르기" }).click();
    await page.getByText("네트워크가 없습니다").waitFor();
    await stage.picture(page, "visit-offline");
    await page.context().setOffline(false);
    await underWay(page);
    await page.locator(".visit-away").waitFor({ state: "detached" });
    const id = await visitorOf(page);
    expect(
      await rows(`SELECT ?run { ?run docent:hasVariable/docent:variableValue <${id}> ; a docent:Run }`),
    ).toHaveLength(1);
    await page.getByRole("button", { name: "서비스 끝내기" }).click();
    await page.getByRole("button", { name: "끝내기", exact: true }).click();
    await page.getByRole("button", { name: /부스 안내/ }).waitFor();
  });

  it("the server is killed while the robot is on its way: the page says so and goes on", async () => {
    const page = await open("/visit?at=B07");
    await call(page, "B09");
    await page.locator(".visit-status:not(.asked)").waitFor();
    await stage.processes.killServer();
    await page.locator(".visit-away").waitFor();
    await stage.picture(page, "visit-away");
    await stage.processes.startServer();
    await page.locator(".visit-away").waitFor({ state: "detached" });
    await underWay(page);
    await page.getByRole("button", { name: "End the service" }).click();
    await page.getByRole("button", { name: "End it" }).click();
    await page.getByRole("button", { name: /Booth guide/ }).waitFor();
  });

  it("a code of a place that is not here is said so; markup stays text", async () => {
    const page = await open("/visit?at=%3Cb%3EB99");
    await page.getByText("The code names a place that is not here: <b>B99").waitFor();
    expect(await page.locator(".visit b b").count()).toBe(0);
  });

  it("by keys alone", async () => {
    const page = await open("/visit?at=B07");
    const service = page.getByRole("button", { name: /Booth guide/ });
    await service.waitFor();
    for (let i = 0; i < 12 && !(await service.evaluate((e) => e === document.activeElement)); i++)
      await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    const map = page.getByRole("button", { name: "Map" });
    await map.waitFor();
    for (let i = 0; i < 12 && !(await map.evaluate((e) => e === document.activeElement)); i++)
      await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    const booth = page.locator('.visit-shape.booth[aria-label^="B02,"]');
    await booth.waitFor();
    for (let i = 0; i < 40 && !(await booth.evaluate((e) => e === document.activeElement)); i++)
      await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Call the robot" }).waitFor();
    await page.goBack();
    await booth.waitFor();
  });

  for (const dark of [false, true])
    it(`no serious finding of axe, and it fits (${dark ? "dark" : "light"})`, async () => {
      const page = await open("/visit?at=B07", { dark });
      await page.getByRole("button", { name: /Booth guide/ }).waitFor();
      await stage.picture(page, `visit-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
      await fitsTheWindow(page);
      await page.getByRole("button", { name: /Booth guide/ }).click();
      await page.getByRole("button", { name: "Map" }).click();
      expect(await seriousFindings(page)).toEqual([]);
      await page.locator('.visit-shape.booth[aria-label^="B02,"]').click();
      await page.getByRole("button", { name: "Call the robot" }).click();
      await page.locator(".visit-status:not(.asked)").waitFor();
      await stage.picture(page, `visit-status-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
      await fitsTheWindow(page);
      await page.getByRole("button", { name: "End the service" }).click();
      await page.getByRole("button", { name: "End it" }).click();
      await page.getByRole("button", { name: /Booth guide/ }).waitFor();
    });

  it("no page has thrown", () => stage.noFaults());
});
