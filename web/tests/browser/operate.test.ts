// Runs, hall and board in a real browser, against fixed answers.
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { fitsTheWindow, seriousFindings } from "./pages";
import { guide, Stage, usualAnswers, type Answers } from "./stage";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const ask = `PREFIX docent: <${docent}>\nPREFIX expo: <${expo}>\nASK { expo:John docent:selected ?booth . }`;

function run(id: string, user: string, node = "waiting", state = "running") {
  return {
    id,
    workflow: "BoothGuide",
    flow: "BoothGuide",
    state,
    startedUs: "1795666887845000",
    variables: [{ name: "user", value: { iri: expo + user } }],
    nodes: [
      {
        name: "Move2User",
        state: "done",
        sinceUs: "1795666891731000",
        firedBecause: `<${expo}R01> <${docent}status> <${docent}Standby> .\n`,
        invocations: [
          { operation: "moveToUser", state: "done", robot: `${expo}R01`, step: "1/1 moveToUser" },
        ],
      },
      {
        name: "Move2Booth",
        state: node,
        sinceUs: "1795666891731000",
        ...(node === "waiting" && { waitsFor: ask }),
        ...(node === "incident" && { reason: "the robot does not answer" }),
      },
      { name: "InfoBooth", state: "inactive" },
    ],
  };
}
const iri = (local: string) => ({ iri: expo + local });
const quad = { subject: iri("John"), predicate: { iri: `${docent}selected` }, object: iri("B01") };

function answers(): Answers {
  const shapes = [
    ["Hall", "Hall", "POLYGON((0 0, 20 0, 20 12, 0 12, 0 0))"],
    ["B01", "Booth", "POLYGON((2 8, 6 8, 6 12, 2 12, 2 8))"],
    ["Entrance", "Region", "POLYGON((0 0, 5 0, 5 4, 0 4, 0 0))"],
    ["<b>x</b>", "Booth", "POLYGON((9 8, 13 8, 13 12, 9 12, 9 8))"],
  ];
  const literal = (lexical: string) => ({ literal: { lexical } });
  return {
    ...usualAnswers(),
    "Workflows/ListRuns": () => ({
      runs: [run("BoothGuide-1", "John"), run("BoothGuide-2", "Ann"), run("BoothGuide-3", "Kim", "incident")],
    }),
    "Workflows/Get": ({ run: id }) =>
      id === "BoothGuide-3"
        ? run("BoothGuide-3", "Kim", "incident")
        : id === "BoothGuide-1"
          ? run("BoothGuide-1", "John")
          : new Error("not_found"),
    "Workflows/Watch": () => [
      {
        revision: "9",
        timeUs: "1795666887845000",
        run: "BoothGuide-1",
        node: "Move2User",
        kind: "node",
        from: "waiting",
        to: "running",
        detail: `condition holds with robot = <${expo}R01>`,
      },
    ],
    "Context/Explain": ({ whyNot }) =>
      whyNot
        ? {
            holds: false,
            more: "11",
            sets: [{ missing: [`<${expo}John> <${docent}selected> ?booth .`], add: [quad] }],
          }
        : {
            holds: true,
            proof: {
              steps: [
                { fact: quad, told: [{ graph: `${expo}R01`, offset: "3", timeUs: "1795666887845000" }] },
              ],
              roots: [0],
            },
          },
    "Workflows/Explain": ({ run: id }) =>
      id === "BoothGuide-3"
        ? {
            waits: [
              {
                node: "Move2Booth",
                kind: "operator",
                detail:
                  "it failed: the robot does not answer; settle it: docent runs retry, skip or fail BoothGuide-3 Move2Booth",
              },
            ],
          }
        : {
            waits: [
              { node: "Move2Booth", kind: "fact", missing: `<${expo}John> <${docent}selected> ?booth .` },
            ],
          },
    "Context/WhatIf": () => ({
      transitions: [{ subject: "BoothGuide-1/Move2Booth", from: "waiting", to: "running" }],
    }),
    "Context/Assert": () => ({ offset: "20", added: "1" }),
    "Workflows/Settle": () => ({}),
    "Workflows/Cancel": () => ({}),
    "Workflows/Pause": () => ({}),
    "Ontologies/Prefixes": () => ({ prefixes: [{ name: "expo", namespace: expo }] }),
    "Context/Query": ({ query }) => {
      const text = String(query);
      if (text.includes("geo:asWKT"))
        return [
          { header: { variables: ["s", "type", "wkt", "name"] } },
          ...shapes.map(([s, type, wkt]) => ({
            row: { values: [iri(s ?? ""), { iri: docent + type }, literal(wkt ?? ""), literal(s ?? "")] },
          })),
        ];
      if (text.includes("docent:Visitor"))
        return [
          { header: { variables: ["p", "name", "region"] } },
          { row: { values: [iri("John"), literal("John"), iri("Entrance")] } },
        ];
      return [
        { header: { variables: ["p", "o"] } },
        { row: { values: [{ iri: `${docent}status` }, { iri: `${docent}Standby` }] } },
      ];
    },
  };
}

let stage: Stage;
beforeAll(async () => {
  stage = await Stage.open();
});
afterAll(() => stage.close());
afterEach(() => expect(stage.faults.splice(0).filter((f) => !/WebSocket/.test(f))).toEqual([]));
const open = async (path: string, options = {}) => {
  stage.answers = answers();
  return stage.page(path, options);
};

describe("operating", () => {
  it("all runs are listed, and the address keeps the choice", async () => {
    const page = await open("/runs");
    await page.getByText("BoothGuide-3").waitFor();
    await page.getByRole("button", { name: "Needs you" }).click();
    await page.waitForFunction(() => location.search === "?state=incident");
    expect(await page.locator("tbody tr").count()).toBe(1);
    await stage.picture(page, "runs");
  });
  it("a run says why not, what would happen, and takes the fact", async () => {
    const page = await open("/runs/BoothGuide-1");
    await page.waitForSelector('.react-flow__node[data-id="Move2Booth"] .state-chip.waiting');
    await page.getByText("Simulate or tell").click();
    await page.locator('dialog input[aria-label="Object"]').fill("expo:B03");
    await page.locator("dialog").getByRole("button", { name: "Simulate" }).click();
    await page.getByText("If it were told").waitFor();
    await stage.picture(page, "run-tell");
    await page.locator("dialog").getByRole("button", { name: "Tell it" }).click();
    await page.waitForSelector(".toast.good");
    const told = stage.calls.find((c) => c.method === "Context/Assert")?.request as {
      add: { object: unknown }[];
    };
    expect(told.add[0]?.object).toEqual({ iri: `${expo}B03` });
  });
  it("a step says why it opened, and by whom that was told", async () => {
    const page = await open("/runs/BoothGuide-1?node=Move2User");
    await page.getByRole("button", { name: "Why?" }).click();
    await page.getByText("told by expo:R01").waitFor();
    await page.getByRole("tab", { name: "History" }).click();
    await page.getByText("condition holds with robot = R01").waitFor();
    await stage.picture(page, "run-history");
  });
  it("a fact that is no longer so says when it was", async () => {
    const page = await open("/runs/BoothGuide-1?node=Move2User");
    const usual = answers();
    stage.answers = {
      ...usual,
      "Context/Explain": () => ({ holds: false }),
      "Context/Query": (q) =>
        String(q["query"]).includes("firedAt")
          ? [
              { header: { variables: ["t"] } },
              { row: { values: [{ literal: { lexical: "2026-11-26T14:03:00Z" } }] } },
            ]
          : usual["Context/Query"]?.(q),
    };
    await page.getByRole("button", { name: "Why?" }).click();
    await page.getByText(/It is no longer so\. It was so at .*\d\d:03:00/).waitFor();
  });
  it("a robot's panel leads to the run and the step that it works for, also within another run", async () => {
    const page = await open("/hall");
    const usual = answers();
    const robot = {
      robot: `${expo}R01`,
      label: "R01",
      state: "busy",
      operations: [],
      hasPose: true,
      xM: 3,
      yM: 9,
      headingRad: 0,
      heldBy: "John's%20Service-6",
      heldFor: [{ run: "BoothGuide-1", node: "Move2Booth", operation: "moveToBooth" }],
    };
    stage.answers = { ...usual, "Fleet/List": () => ({ robots: [robot] }) };
    await page.goto(`${stage.url}/hall?at=expo:R01`);
    const panel = page.locator(".hall-details");
    expect(await panel.getByRole("link", { name: "John's Service-6" }).getAttribute("href")).toBe(
      "/runs/John's%20Service-6",
    );
    await panel.getByRole("link", { name: "BoothGuide-1" }).first().click();
    await page.locator('.react-flow__node[data-id="Move2Booth"].selected').waitFor();
  });
  it("a robot that is offline in the middle of a run is said in the list, on its page and in the hall, which does not say that it goes on", async () => {
    const page = await open("/runs");
    const usual = answers();
    const driving = {
      ...run("BoothGuide-1", "John", "running"),
      nodes: run("BoothGuide-1", "John", "running").nodes.map((n) =>
        n.name === "Move2Booth"
          ? {
              ...n,
              invocations: [
                { operation: "moveToBooth", state: "running", robot: `${expo}R01`, progress: 0.4 },
              ],
            }
          : n,
      ),
    };
    const robot = {
      robot: `${expo}R01`,
      label: "R01",
      state: "offline",
      lastSeenUs: "1795666891731000",
      operations: [],
      hasPose: true,
      xM: 3,
      yM: 9,
      headingRad: 0,
      heldBy: "BoothGuide-1",
      heldFor: [{ run: "BoothGuide-1", node: "Move2Booth", operation: "moveToBooth" }],
    };
    stage.answers = {
      ...usual,
      "Fleet/List": () => ({ robots: [robot] }),
      "Workflows/ListRuns": () => ({ runs: [driving, run("BoothGuide-2", "Ann")] }),
      "Workflows/Get": () => driving,
    };
    await page.goto(`${stage.url}/runs`);
    await page
      .locator("tbody tr", { hasText: "BoothGuide-1" })
      .locator(".tag.wait", { hasText: /R01 offline since .*:31/ })
      .waitFor();
    expect(await page.locator(".tag", { hasText: "offline" }).count()).toBe(1);
    await stage.picture(page, "runs-offline");
    await page.locator("tbody tr", { hasText: "BoothGuide-1" }).click();
    await page.locator(".stale", { hasText: /R01 has been offline since/ }).waitFor();
    await stage.picture(page, "run-offline");
    await page.goto(`${stage.url}/hall`);
    await page.locator(".hall-row", { hasText: /not seen since .*; it had begun: move to booth/ }).waitFor();
  });
  it("a step that has ended says when, and how long it took", async () => {
    const page = await open("/runs/BoothGuide-1?node=Move2User");
    const usual = answers();
    stage.answers = {
      ...usual,
      "Context/Query": (q) =>
        String(q["query"]).includes("firedAt")
          ? [
              { header: { variables: ["t"] } },
              { row: { values: [{ literal: { lexical: new Date(1795666887731).toISOString() } }] } },
            ]
          : usual["Context/Query"]?.(q),
    };
    await page.reload();
    await page.locator(".run-section .small.number", { hasText: /^at .*:31.*, took 4\.0 s$/ }).waitFor();
  });
  it("a phone that is turned shows the flow; the menu can be passed over and reached whole", async () => {
    const page = await open("/runs/BoothGuide-1", { width: 844, height: 390 });
    await page.waitForSelector('.react-flow__node[data-id="Move2Booth"]');
    const box = (await page.getByRole("button", { name: "Dark colours" }).boundingBox())!;
    expect(box.y + box.height).toBeLessThanOrEqual(390);
    const seen = () =>
      page.evaluate(() => {
        const pane = document.querySelector(".react-flow")!.getBoundingClientRect();
        return [...document.querySelectorAll(".react-flow__node")].filter((n) =>
          ((b) =>
            b.left >= pane.left && b.right <= pane.right && b.top >= pane.top && b.bottom <= pane.bottom)(
            n.getBoundingClientRect(),
          ),
        ).length;
      });
    for (const size of [
      { width: 390, height: 844 },
      { width: 844, height: 390 },
    ]) {
      await page.setViewportSize(size);
      await expect.poll(seen).toBeGreaterThan(0);
      await stage.picture(page, `run-turned-${size.width}`);
    }
    await page.goto(`${stage.url}/runs`);
    await page.getByRole("heading", { name: "Runs" }).waitFor();
    await page.keyboard.press("Tab");
    expect(await page.evaluate(() => document.activeElement?.textContent)).toBe("Skip the menu");
    await page.keyboard.press("Enter");
    expect(await page.evaluate(() => document.activeElement?.id)).toBe("view");
    await page.setViewportSize({ width: 390, height: 844 });
    await stage.picture(page, "runs-phone");
  });
  it("an incident is settled", async () => {
    const page = await open("/runs/BoothGuide-3");
    await page.getByRole("button", { name: "Count as done" }).click();
    await page.waitForSelector(".toast.good");
    expect(stage.calls.find((c) => c.method === "Workflows/Settle")?.request).toMatchObject({
      run: "BoothGuide-3",
      node: "Move2Booth",
      how: "SKIP",
    });
  });
  it("a run that is gone is said so", async () => {
    const page = await open("/runs/Old-1");
    await page.getByText("There is no run Old-1").waitFor();
  });
  it("everything that waits is grouped by what lacks", async () => {
    const page = await open("/board");
    await page.getByText("John selected a booth").waitFor(); // any of twelve would do: they are one thing
    expect(await page.locator(".board-group").count()).toBe(2);
    expect(await page.locator(".board-group", { hasText: "A fact is missing" }).locator("li").count()).toBe(
      2,
    );
    expect(await page.getByText("other ways").count()).toBe(0);
    await stage.picture(page, "board");
  });
  it("what robots tell of themselves is not offered to be told; why none can come, and which hangs in mid-drive, is said", async () => {
    const page = await open("/board");
    const usual = answers();
    const off = {
      robot: `${expo}R01`,
      label: "R01",
      state: "offline",
      address: "127.0.0.1:44367",
      lastSeenUs: "1795666891731000",
      operations: [],
      heldBy: "BoothGuide-1",
      heldFor: [{ run: "BoothGuide-1", node: "Move2Booth", operation: "moveToBooth" }],
    };
    const status = {
      subject: iri("R01"),
      predicate: { iri: `${docent}status` },
      object: { iri: `${docent}Standby` },
    };
    const lostReason =
      "adapter at 127.0.0.1:44367 broke off the feedback of a command that has not ended: recvmsg:Connection reset by peer";
    const hangs = {
      ...run("BoothGuide-1", "John", "running"),
      nodes: run("BoothGuide-1", "John", "running").nodes.map((n) =>
        n.name === "Move2Booth"
          ? {
              ...n,
              invocations: [
                {
                  operation: "moveToBooth",
                  state: "running",
                  robot: `${expo}R01`,
                  step: "1/1 moveToBooth",
                  reason: lostReason,
                },
              ],
            }
          : n,
      ),
    };
    stage.answers = {
      ...usual,
      "Fleet/List": () => ({ robots: [off] }),
      "Workflows/ListRuns": () => ({ runs: [hangs, run("BoothGuide-2", "Ann")] }),
      "Workflows/Get": ({ run: id }) => (id === "BoothGuide-1" ? hangs : run("BoothGuide-2", "Ann")),
      "Workflows/Explain": ({ run: id }) => ({
        waits: [
          id === "BoothGuide-1"
            ? { node: "Move2Booth", kind: "command", robot: `${expo}R01`, detail: lostReason }
            : {
                node: "Move2Booth",
                kind: "fact",
                missing: `<${expo}R01> <${docent}status> <${docent}Standby> . <${expo}R01> <${docent}localised> true .`,
              },
        ],
      }),
      "Context/Explain": () => ({
        holds: false,
        sets: [{ missing: ["expo:R01 docent:status docent:Standby"], add: [status] }],
      }),
    };
    await page.goto(`${stage.url}/board`);
    await page
      .locator(".board-group", { hasText: "A robot is offline in the middle of it" })
      .getByText(/R01 is offline since .*:31/)
      .waitFor();
    await page
      .locator(".board-group", { hasText: "A robot is needed" })
      .getByText(/No robot can come: R01 is offline since .*:31/)
      .waitFor();
    expect(await page.getByRole("button", { name: "Simulate or tell" }).count()).toBe(0);
    await stage.picture(page, "board-robot-offline");
    await page.goto(`${stage.url}/runs/BoothGuide-2`);
    await page
      .locator(".lack", { hasText: "No robot can come" })
      .getByText("The robot tells this itself.")
      .waitFor();
    await stage.picture(page, "run-robot-offline");
    await page.goto(`${stage.url}/runs/BoothGuide-1`);
    await page.locator('[title*="recvmsg"]', { hasText: "the connection to R01 broke off" }).waitFor();
    expect(await page.getByText("recvmsg").count()).toBe(0);
    await stage.picture(page, "run-hangs");
    await page.goto(`${stage.url}/desk`);
    await page
      .locator(".desk-runs li", { hasText: "Move2Booth waits · No robot can come: R01 is offline since" })
      .waitFor();
    await page.locator(".desk-runs li", { hasText: "user Ann" }).waitFor();
    await stage.picture(page, "desk-robot-offline");
    // The status of a robot is refused in the dialog, too.
    await page.keyboard.press("Control+k");
    await page.keyboard.type("tell a fact");
    await page.keyboard.press("Enter");
    for (const [label, value] of [
      ["Subject", "expo:R01"],
      ["Verb", "docent:status"],
      ["Object", "docent:Standby"],
    ])
      await page.locator(`dialog input[aria-label="${label}"]`).fill(value ?? "");
    await page.locator("dialog").getByText("R01 tells this itself, and is offline").waitFor();
    expect(await page.locator("dialog").getByRole("button", { name: "Tell it" }).count()).toBe(0);
  });
  it("where its robot is out of service, that is the cause: it is put in service, looked at, or another one is given to the run", async () => {
    const page = await open("/runs");
    const usual = answers();
    const bound = {
      ...run("BoothGuide-1", "John"),
      variables: [...run("BoothGuide-1", "John").variables, { name: "robot", value: iri("R01") }],
    };
    const standby = { state: "standby", hasPose: true, operations: ["moveToBooth"] };
    const out = {
      robot: `${expo}R01`,
      label: "R01",
      address: "127.0.0.1:1",
      outOfService: true,
      outOfServiceReason: "a wheel is loose",
      ...standby,
    };
    const missing = `<${expo}R01> <${docent}isAt> <${expo}Entrance> .`;
    stage.calls = [];
    stage.answers = {
      ...usual,
      "Fleet/List": () => ({
        robots: [out, { robot: `${expo}R02`, label: "R02", address: "127.0.0.1:2", ...standby }],
      }),
      "Fleet/PutInService": () => ({}),
      "Workflows/SetVariable": () => bound,
      "Workflows/ListRuns": () => ({ runs: [bound] }),
      "Workflows/Get": () => bound,
      "Workflows/Explain": () => ({ waits: [{ node: "Move2Booth", kind: "fact", missing }] }),
      "Context/Explain": () => ({
        holds: false,
        sets: [
          {
            missing: ["expo:R01 docent:isAt expo:Entrance"],
            add: [{ subject: iri("R01"), predicate: { iri: `${docent}isAt` }, object: iri("Entrance") }],
          },
        ],
      }),
    };
    await page.goto(`${stage.url}/board`);
    const group = page.locator(".board-group", { hasText: "A robot is needed" });
    await group.getByText("R01 is out of service: a wheel is loose").waitFor();
    expect(await page.getByText("is at Entrance").count()).toBe(0);
    expect(await page.getByRole("button", { name: "Simulate or tell" }).count()).toBe(0);
    expect(await group.getByRole("link", { name: "See it in the hall" }).getAttribute("href")).toContain(
      "R01",
    );
    await stage.picture(page, "board-out-of-service");
    expect(await seriousFindings(page)).toEqual([]);
    await group.getByRole("button", { name: "Put R01 in service" }).click();
    await page.locator(".toast.good", { hasText: "R01 is in service" }).waitFor();
    await group.getByRole("button", { name: "Give the run another robot" }).click();
    await stage.picture(page, "board-another-robot");
    await page.locator("dialog").getByRole("button", { name: /R02/ }).click();
    await page.locator(".toast.good", { hasText: "The run waits for R02 now" }).waitFor();
    expect(stage.calls.find((c) => c.method === "Workflows/SetVariable")?.request).toEqual({
      run: "BoothGuide-1",
      variable: { name: "robot", value: iri("R02") },
    });
    // The same on the run's page.
    await page.goto(`${stage.url}/runs/BoothGuide-1`);
    await page
      .locator(".lack", { hasText: "out of service: a wheel is loose" })
      .getByRole("button", { name: "Put R01 in service" })
      .waitFor();
    await page.getByRole("button", { name: "Give the run another robot" }).waitFor();
    await stage.picture(page, "run-out-of-service");
  });
  it("a robot is taken out of service with a reason", async () => {
    const page = await open("/hall?at=expo:R01");
    stage.calls = [];
    stage.answers = { ...answers(), "Fleet/TakeOutOfService": () => ({}) };
    await page.getByRole("button", { name: "Take out of service" }).click();
    await page.keyboard.type("a wheel is loose");
    await stage.picture(page, "robot-take-out");
    await page.keyboard.press("Enter");
    await page.locator(".toast.good", { hasText: "R01 is out of service" }).waitFor();
    expect(stage.calls.find((c) => c.method === "Fleet/TakeOutOfService")?.request).toMatchObject({
      robot: `${expo}R01`,
      reason: "a wheel is loose",
    });
  });
  it("a pause says that the robot goes on, and can stop it", async () => {
    const page = await open("/runs");
    const usual = answers();
    const driving = {
      ...run("BoothGuide-1", "John", "running"),
      paused: false,
      nodes: run("BoothGuide-1", "John", "running").nodes.map((n) =>
        n.name === "Move2Booth"
          ? {
              ...n,
              invocations: [
                {
                  operation: "moveToBooth",
                  state: "running",
                  robot: `${expo}R01`,
                  command: "c1",
                  progress: 0.4,
                },
              ],
            }
          : n,
      ),
    };
    stage.answers = {
      ...usual,
      "Workflows/ListRuns": () => ({ runs: [driving] }),
      "Workflows/Get": () => driving,
    };
    stage.calls = [];
    await page.goto(`${stage.url}/runs/BoothGuide-1`);
    await page.getByRole("button", { name: "Pause", exact: true }).click();
    await page.locator("dialog").getByText("R01 still does Move2Booth (move to booth)").waitFor();
    await stage.picture(page, "run-pause");
    await page.getByRole("button", { name: "Let it finish" }).click();
    await page.locator(".toast.good", { hasText: "The run is paused" }).waitFor();
    driving.paused = true;
    const bar = page.locator(".stale", { hasText: "Paused: R01 still does Move2Booth" });
    await bar.waitFor();
    await stage.picture(page, "run-paused");
    await bar.getByRole("button", { name: "Stop it now" }).click();
    await expect
      .poll(() =>
        stage.calls
          .filter((c) => c.method === "Workflows/Pause")
          .map((c) => c.request["cancelCommands"] ?? false),
      )
      .toEqual([false, true]);
    // Where nothing is under way, there is nothing to ask.
    stage.answers = answers();
    await page.goto(`${stage.url}/runs/BoothGuide-1`);
    await page.getByRole("button", { name: "Pause", exact: true }).click();
    await expect.poll(() => stage.calls.filter((c) => c.method === "Workflows/Pause").length).toBe(3);
  });
  it("what a robot says stays as it is, with its markup", async () => {
    const page = await open("/runs");
    const usual = answers();
    stage.answers = {
      ...usual,
      "Workflows/Watch": () => [
        {
          revision: "9",
          timeUs: "1795666887845000",
          run: "BoothGuide-1",
          node: "Move2User",
          kind: "command",
          to: "sent",
          detail: `BoothGuide-1/Move2User/0/0.1/1/1@17 to <${expo}R01>: say(text="See you <b>soon</b> & <http://x.org/y#z>"), guard as of 19`,
        },
      ],
    };
    await page.goto(`${stage.url}/runs/BoothGuide-1`);
    await page.getByRole("tab", { name: "History" }).click();
    await page.getByText('say(text="See you <b>soon</b> & <http://x.org/y#z>")').waitFor();
  });
  it("a view can be printed: without the menu, in light colours, whole", async () => {
    const page = await open("/runs", { dark: true });
    await page.getByText("BoothGuide-3").waitFor();
    await page.emulateMedia({ media: "print" });
    expect(await page.locator(".rail").isVisible()).toBe(false);
    expect(await page.locator(".time-bar").isVisible()).toBe(false);
    expect(await page.locator("tbody tr").count()).toBe(3);
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    expect((await page.locator(".runs").boundingBox())!.width).toBeGreaterThan(1200); // the whole paper
    await stage.picture(page, "runs-print");
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("dark");
  });
  it("without a server the hall says so in its middle, and nothing is called live", async () => {
    const page = await open("/runs");
    await page.getByText("BoothGuide-3").waitFor();
    stage.answers = null;
    await page.getByRole("link", { name: "Hall" }).click();
    await page.getByRole("button", { name: "Not live" }).waitFor();
    const message = page.locator(".hall-stage .nothing");
    await message.waitFor();
    await stage.picture(page, "hall-away");
    const [box, pane] = [await message.boundingBox(), await page.locator(".hall-stage").boundingBox()];
    expect(box!.width).toBeCloseTo(pane!.width, 0);
    expect(await page.locator(".stale").innerText()).toMatch(/since \S.*\S\. What you see may be old/);
  });
  it("the hall shows robots, people and booths; markup stays text", async () => {
    const page = await open("/hall");
    await page.waitForSelector(".hall-robot");
    expect(await page.locator(".hall-svg b").count()).toBe(0);
    await page.locator(".hall-robot").click();
    await page.waitForFunction(() => location.search.includes("R01"));
    await page.locator(".hall-details").getByText("docent:Standby").waitFor();
    await stage.picture(page, "hall");
  });
  it("the server goes and comes back: what is shown stays, and says that it is old", async () => {
    const page = await open("/runs");
    await page.getByText("BoothGuide-3").waitFor();
    stage.answers = null;
    await page.waitForSelector(".stale");
    expect(await page.locator("tbody tr").count()).toBe(3);
    stage.answers = answers();
    await page.waitForSelector(".stale", { state: "detached" });
  });
  it("a run's text is the one that the server has", async () => {
    const page = await open("/runs/BoothGuide-1");
    await page.waitForSelector('.react-flow__node[data-id="InfoBooth"]');
    expect(guide).toContain("InfoBooth");
    await page.getByRole("link", { name: "BoothGuide", exact: true }).click();
    await page.waitForSelector(".dock-properties");
  });
});

describe("for everybody", () => {
  for (const dark of [false, true])
    for (const [path, wait] of [
      ["/runs", "tbody tr"],
      ["/runs/BoothGuide-1?node=Move2Booth", ".lack"],
      ["/hall", ".hall-robot"],
      ["/board", ".board-group"],
    ] as const)
      it(`${path} has no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
        const page = await open(path, { dark });
        await page.waitForSelector(wait);
        if (dark) await stage.picture(page, `dark-${path.replace(/\W+/g, "-")}`);
        expect(await seriousFindings(page)).toEqual([]);
      });
  it("the views fit a small window", async () => {
    for (const [path, wait] of [
      ["/runs", "tbody tr"],
      ["/hall", ".hall-robot"],
      ["/board", ".board-group"],
      ["/runs/BoothGuide-1", ".lack"],
    ] as const) {
      const narrow = await open(path, { width: 320, height: 700 });
      await narrow.waitForSelector(wait);
      await stage.picture(narrow, `narrow-${path.replace(/\W+/g, "-")}`);
      await fitsTheWindow(narrow);
      expect(
        await narrow.evaluate(
          () =>
            [...document.querySelectorAll("td .tag")].filter(
              (e) =>
                e.getBoundingClientRect().width > 0 && e.getBoundingClientRect().right > window.innerWidth,
            ).length,
        ),
      ).toBe(0);
      const page = await open(path, { width: 390, height: 780 });
      await page.waitForSelector(wait);
      await stage.picture(page, `small-${path.replace(/\W+/g, "-")}`);
      await fitsTheWindow(page);
      const seen = {
        "/runs": page.getByRole("button", { name: "Cancelled" }),
        "/runs/BoothGuide-1": page.getByRole("link", { name: "Back to all runs" }),
      }[path as string];
      if (seen)
        expect(
          await seen.evaluate(
            (thing) =>
              thing.getBoundingClientRect().right <= window.innerWidth &&
              thing.getBoundingClientRect().width > 0,
          ),
        ).toBe(true);
    }
  });
});
