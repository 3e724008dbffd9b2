// What is seen of drawings in windows of other shapes, and how large their letters are.
import { describe, expect, it } from "vitest";
import { beginning, isAnySeen, withPiece } from "../../../src/flow/refit";
import { broughtIntoView, lettersAt, linesOf } from "../../../src/hall/hall_drawing";
import type { Shape } from "../../../src/hall/layout";

describe("a flow in a window", () => {
  const steps = [
    { position: { x: 0, y: 0 }, width: 240, height: 60 },
    { position: { x: 0, y: 100 }, width: 240, height: 60 },
  ];
  it("is seen where one step is seen whole, or the middle of one that is larger than the window", () => {
    expect(isAnySeen(steps, { x: 100, y: 20, zoom: 1 }, { width: 800, height: 300 })).toBe(true);
    expect(isAnySeen(steps, { x: 360, y: 20, zoom: 1 }, { width: 390, height: 300 })).toBe(false); // the phone was turned
    expect(isAnySeen(steps, { x: -40, y: 20, zoom: 2 }, { width: 390, height: 300 })).toBe(true);
    expect(isAnySeen(steps, { x: -400, y: 20, zoom: 2 }, { width: 390, height: 300 })).toBe(false);
  });
  it("has the step that is asked for in view, and stays where it has it already", () => {
    const last = { position: { x: 0, y: 700 }, width: 240, height: 120 };
    const view = { x: 100, y: 28, zoom: 0.5 };
    expect(withPiece(last, view, { width: 700, height: 600 })).toBe(view);
    expect(withPiece(last, view, { width: 700, height: 190 })).toEqual({ x: 290, y: 95 - 380, zoom: 0.5 });
  });
});

describe("a drawing that has no room", () => {
  it("begins with whole steps, smaller where that shows all that stand beside each other", () => {
    expect(beginning({ x: 0, y: 100, width: 240 }, 600, 0.6, 0.45)).toEqual({
      x: 300 - 72,
      y: 16 - 60,
      zoom: 0.6,
    });
    const wide = beginning({ x: -240, y: 0, width: 1100 }, 600, 0.6, 0.45);
    expect(wide.zoom).toBeCloseTo(568 / 1100);
    expect(wide.x - 240 * wide.zoom).toBeCloseTo(16);
    const wider = beginning({ x: -240, y: 0, width: 3000 }, 600, 0.6, 0.45);
    expect([wider.zoom, wider.x - 240 * wider.zoom]).toEqual([0.45, 16]);
  });
});

describe("the names on the map", () => {
  const booth = (wide: number): Shape => ({
    iri: "a",
    kind: "booth",
    name: "B01",
    detail: "Palmwright Robotics",
    rings: [
      [
        { x: 0, y: 0 },
        { x: wide, y: 4 },
      ],
    ],
    radius: 0,
    label: { x: 0, y: 0 },
  });
  it("are as large on the screen however near the hall is, and can be read on a phone", () => {
    for (const whole of [0.03, 0.09])
      // metres a pixel: a large window, a phone
      for (const scale of [1, 0.5, 0.1]) {
        const letters = lettersAt(whole * scale, whole);
        for (const [name, metres] of Object.entries(letters)) {
          expect(metres / (whole * scale)).toBeCloseTo(
            lettersAt(whole, whole)[name as keyof typeof letters] / whole,
          );
          expect(metres / (whole * scale)).toBeGreaterThanOrEqual(11);
          expect(metres / (whole * scale)).toBeLessThanOrEqual(20);
        }
      }
  });
  it("are left out where they have no room, until they are nearer; a booth's number always stands", () => {
    const detail = (wide: number, at: number, whole: number) =>
      linesOf(booth(wide), lettersAt(at, whole)).lines.map((l) => l.text);
    expect([detail(5, 0.03, 0.03), detail(4, 0.03, 0.03)]).toEqual([
      ["Palmwright Robotics"],
      ["Palmwright", "Robotics"],
    ]);
    expect(linesOf(booth(5), lettersAt(0.09, 0.09))).toMatchObject({ name: { text: "B01" }, lines: [] });
    expect(detail(5, 0.09 * 0.4, 0.09)).toEqual(["Palmwright Robotics"]);
    expect(
      linesOf({ ...booth(2), kind: "region", name: "Long name of a small place" }, lettersAt(0.09, 0.09)).name
        .text,
    ).toBe("");
  });
  it("what is chosen in a list comes into view, and the camera stays where it is seen", () => {
    const layout = { min: { x: 0, y: 0 }, max: { x: 30, y: 20 } };
    expect(broughtIntoView(null, layout, { x: 29, y: 1 })).toBe(null);
    const camera = { x: 5, y: 5, scale: 0.2 };
    expect(broughtIntoView(camera, layout, { x: 6, y: 6 })).toBe(camera);
    expect(broughtIntoView(camera, layout, { x: 25, y: 6 })).toEqual({ x: 25, y: 6, scale: 0.2 });
  });
});
