// Names on the map: beside their things, and not over what is written there.
import { expect, it } from "vitest";
import { placeLabels, textBox } from "../../../src/hall/label_places";

const robot = { key: "R01", x: 0, y: 0, radius: 0.6, text: "R01", size: 0.62 };

it("a name stands above its thing, or elsewhere where another name is", () => {
  expect(placeLabels([], [robot]).get("R01")).toMatchObject({ x: 0 });
  expect(placeLabels([], [robot]).get("R01")!.y).toBeLessThan(0);
  const over = textBox(0, -0.75, "B04", 0.74);
  expect(placeLabels([over], [robot]).get("R01")!.y).toBeGreaterThan(0);
});
it("two things side by side have names that do not cover each other", () => {
  const places = placeLabels([], [robot, { ...robot, key: "R02", text: "Guest 0289", x: 0.4 }]);
  expect(places.get("R01")).not.toEqual(places.get("R02"));
});
